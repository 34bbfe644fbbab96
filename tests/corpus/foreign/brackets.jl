ode = @ODEmodel(x'(t) = ((a*x(t), y(t) = x(t))

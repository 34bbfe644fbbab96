# Cholera with water as a reservoir, and what a hospital counts:
# M. C. Eisenberg, S. L. Robertson and J. H. Tien, Identifiability and estimation of
# multiple transmission pathways in cholera and waterborne disease, J. Theor. Biol. 324 (2013)
using StructuralIdentifiability

siwr = @ODEmodel(
    S'(t) = μ - β_I * S(t) * I(t) - β_W * S(t) * W(t) - μ * S(t) + α * R(t),
    I'(t) = β_W * S(t) * W(t) + β_I * S(t) * I(t) - (γ + μ) * I(t),
    W'(t) = ξ * (I(t) - W(t)),   # scaled by the rate of shedding
    R'(t) = γ * I(t) - (μ + α) * R(t),
    y(t) = κ * I(t)
)

#= the same with the number of people counted as well,
   a decimal, a fraction and a coefficient without a sign =#
counted = @ODEmodel(
    S'(t) = μ - β_I * S(t) * I(t) - β_W * S(t) * W(t) - μ * S(t) + α * R(t),
    I'(t) = β_W * S(t) * W(t) + β_I * S(t) * I(t) - (γ + μ) * I(t) + 1//2 * u(t)^2 / (0.25 + 2u(t)^2),
    W'(t) = ξ * (I(t) - W(t)),
    R'(t) = γ * I(t) - (μ + α) * R(t),
    y1(t) = κ * I(t),
    y2(t) = S(t) + I(t) + R(t)
)

println(assess_identifiability(siwr))

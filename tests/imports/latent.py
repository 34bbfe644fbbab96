"""HIV with cells that are infected and not yet productive."""
#--------------------------------------------------------------
# H. Miao, X. Xia, A. S. Perelson and H. Wu, On identifiability of nonlinear ODE models
# and applications in viral dynamics, SIAM Review 53 (2011)
#--------------------------------------------------------------
import sympy as sym

# 4 states: targets, latent cells, productive cells, virus
x1, x2, x3, x4 = sym.symbols('x1 x2 x3 x4')
x = [[x1], [x2], [x3], [x4]]

# 2 outputs
h = [x1, x4]

# inputs
u = []
w = []

# 10 parameters
b, c, d = sym.symbols('b, c, d')
q1 = sym.Symbol('q1')
q2 = sym.Symbol('q2')
k1, k2, w1, w2, s = sym.symbols('k1 k2 w1 w2 s', positive=True)
p = [[b], [c], [d], [q1], [q2],
     [k1], [k2], [w1], [w2], [s]]

# dynamic equations
infection = b*x1*x4**1
f = [[-infection - d*x1 + s], [q1*infection - k1*x2 - w1*x2],
     [q2*infection + k1*x2 - w2*x3], [-c*x4 + k2*x3]]

variables_locales = locals().copy()

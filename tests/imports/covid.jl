# K. Roosa and G. Chowell, Assessing parameter identifiability in compartmental dynamic models
# using a computational approach, Theor. Biol. Med. Model. 16 (2019)
using StructuralIdentifiability, ModelingToolkit

@parameters b q N_inv k r α g₁ g₂
@variables t S(t) E(t) A(t) I(t) J(t) C(t) infectious(t) y1(t) y2(t)
D = Differential(t)

eqs = [
    infectious ~ I + J + q * A,
    D(S) ~ -b * S * infectious * N_inv,
    D(E) ~ b * S * infectious * N_inv - k * E,
    D(A) ~ k * (1 - r) * E - g₁ * A,
    D(I) ~ k * r * E - (α + g₁) * I,
    D(J) ~ α * I - g₂ * J,
    D(C) ~ α * I,
]
@named model = ODESystem(eqs, t)
measured_quantities = [y1 ~ C, y2 ~ N_inv]
assess_identifiability(model, measured_quantities = measured_quantities)

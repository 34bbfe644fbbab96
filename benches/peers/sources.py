"""The models of proofs/benchmarks beside what other people wrote down of the same papers: sources.py [NAME ...]

Each entry has the equations of a source in the source's own names, or its reactions, and how its names and ours are related. All rates (and outputs
where the source has them) are evaluated at random states; exit status 1 where they differ. What was compared with what is said at the head of each
proof file. Nothing here is taken from a proof file, and the proof files are read by the plain reader of the other programs in this folder.
"""

import math
import random
import re
import sys

from model_files import BENCHMARKS
from proof_file import ProofFile

STATES = 20
MATH = {name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "exp")}


def value(text, names):
    return eval(text.replace("^", "**"), {"__builtins__": {}}, MATH | names)


def summed(text, species):
    """Rates by reactions, a line each: A + B -> C : rate; what is at neither end is written with nothing there."""
    rates = {name: [] for name in species}
    for line in text.strip().splitlines():
        ends, rate = line.split(":")
        for end, sign in zip(ends.split("->"), "-+"):
            for name in re.findall(r"\w+", end):
                rates[name].append(f"{sign}({rate.strip()})")
    return {ours: "".join(rates[name]) or "0" for name, ours in species.items() if ours}


def equations(text):
    return dict(re.split(r"\s*=\s*", line.strip(), maxsplit=1) for line in text.strip().splitlines())


# free: names that are drawn besides; ours: names of ours by these; theirs: names of the source by ours. u1, u2 are the inputs of a proof file in its order.
SOURCES = {
    # Data2Dynamics/d2d, Crauste_ImmuneCells_CellSystems2017/Models/ModelImmuneCells.def; it has no death of memory cells
    "crauste": {
        "ours": {"mu_M": "0"},
        "theirs": {"Naive": "N", "Early": "E", "Late": "S", "Memory": "M", "Pathogen": "P"},
        "rates": summed(
            """Naive -> : mu_N*Naive
               Naive -> Early : delta_NE*Pathogen*Naive
               -> Early : rho_E*Pathogen*Early
               Early -> : mu_EE*Early*Early
               Early -> Late : delta_EL*Early
               Late -> : mu_LL*Late*Late
               Late -> : mu_LE*Early*Late
               Late -> Memory : delta_LM*Late
               -> Pathogen : rho_P*Pathogen*Pathogen
               Pathogen -> : mu_PE*Early*Pathogen
               Pathogen -> : mu_PL*Late*Pathogen
               Pathogen -> : mu_P*Pathogen""",
            {"Naive": "N", "Early": "E", "Late": "S", "Memory": "M", "Pathogen": "P"},
        ),
    },
    # Data2Dynamics/d2d, Raia_CancerResearch2011/Models/il13_jak2_stat5.def and Data/MedB1_real_data.def
    "raia": {
        "theirs": {
            "Rec": "x1", "Rec_i": "x2", "IL13_Rec": "x3", "p_IL13_Rec": "x4", "p_IL13_Rec_i": "x5", "JAK2": "x6", "pJAK2": "2.8 - x6", "STAT5": "x8",
            "pSTAT5": "165 - x8", "mRNA": "x10", "DecoyR": "x11", "IL13_DecoyR": "0.34 - x11", "SOCS3": "x13", "CD274": "x10*t17/t11", "IL13": "u1",
        },
        "rates": summed(
            """Rec -> IL13_Rec : IL13*t1*2.265*Rec
               Rec -> Rec_i : t5*Rec
               Rec_i -> Rec : t6*Rec_i
               IL13_Rec -> p_IL13_Rec : pJAK2*t2*IL13_Rec
               JAK2 -> pJAK2 : IL13_Rec*JAK2*t7/(1 + SOCS3*t13)
               JAK2 -> pJAK2 : p_IL13_Rec*t7*JAK2/(1 + SOCS3*t13)
               p_IL13_Rec -> p_IL13_Rec_i : t3*p_IL13_Rec
               p_IL13_Rec_i -> : t4*p_IL13_Rec_i
               pJAK2 -> JAK2 : 91*t8*pJAK2
               STAT5 -> pSTAT5 : pJAK2*t9*STAT5
               pSTAT5 -> STAT5 : 91*t10*pSTAT5
               DecoyR -> IL13_DecoyR : IL13*2.265*t12*DecoyR
               -> mRNA : pSTAT5*t11
               -> SOCS3 : mRNA*t14/(mRNA + t15)
               SOCS3 -> : t16*SOCS3""",
            {"Rec": "x1", "Rec_i": "x2", "IL13_Rec": "x3", "p_IL13_Rec": "x4", "p_IL13_Rec_i": "x5", "JAK2": "x6", "pJAK2": "", "STAT5": "x8"}
            | {"pSTAT5": "", "mRNA": "x10", "DecoyR": "x11", "IL13_DecoyR": "", "SOCS3": "x13"},
        ),
        "outputs": [
            "Rec + IL13_Rec + p_IL13_Rec", "t18*(IL13_Rec + p_IL13_Rec + p_IL13_Rec_i + IL13_DecoyR)", "t19*(p_IL13_Rec + p_IL13_Rec_i)",
            "t20*pJAK2", "t21*mRNA", "t22*CD274", "SOCS3", "pSTAT5",
        ],
    },
    # Benchmark-Models-PEtab, model_Fujita_SciSignal2010.xml; outputs by STRIKE-GOLDD, z_create_Fujita.m
    "fujita": {
        "rates": summed(
            """EGFR -> EGF_EGFR : u1*EGFR*reaction_1_k1 - EGF_EGFR*reaction_1_k2
               pEGFR + Akt -> pEGFR_Akt : Akt*pEGFR*reaction_2_k1 - pEGFR_Akt*reaction_2_k2
               pEGFR_Akt -> pEGFR + pAkt : pEGFR_Akt*reaction_3_k1
               pEGFR -> : pEGFR*reaction_4_k1
               pAkt + S6 -> pAkt_S6 : S6*pAkt*reaction_5_k1 - pAkt_S6*reaction_5_k2
               pAkt_S6 -> pAkt + pS6 : pAkt_S6*reaction_6_k1
               pAkt -> Akt : pAkt*reaction_7_k1
               pS6 -> S6 : pS6*reaction_8_k1
               EGF_EGFR -> pEGFR : EGF_EGFR*reaction_9_k1
               EGFR -> : EGFR*EGFR_turnover
               -> EGFR : 68190*EGFR_turnover""",
            {name: name for name in "EGFR pEGFR pEGFR_Akt Akt pAkt S6 pAkt_S6 pS6 EGF_EGFR".split()},
        ),
        "outputs": ["a1*(pEGFR + pEGFR_Akt)", "a2*(pAkt + pAkt_S6)", "a3*pS6"],
    },
    # Benchmark-Models-PEtab, model_Bruno_JExpBio2016.xml, the multipliers one
    "bruno2016": {
        "rates": summed(
            """beta -> beta10 + betaio : beta*kbeta
               beta10 -> betaio : beta10*kbeta10
               cry -> beta10 + OHbetaio : cry*kcryOH
               cry -> betaio + OHbeta10 : cry*kcrybeta
               OHbeta10 -> OHbetaio : kOHbeta10*OHbeta10
               zea -> OHbeta10 + OHbetaio : kzea*zea""",
            {name: name for name in "beta cry zea beta10 OHbeta10 betaio OHbetaio".split()},
        ),
    },
    # the reactions of two sites, by mass action: written out here, since the one file that was found has its right sides at other states
    "mapk5": {
        "rates": summed(
            """K + S00 -> KS00 : a00*K*S00 - b00*KS00
               KS00 -> K + S01 : c0001*KS00
               KS00 -> K + S10 : c0010*KS00
               KS00 -> K + S11 : c0011*KS00
               K + S01 -> KS01 : a01*K*S01 - b01*KS01
               KS01 -> K + S11 : c0111*KS01
               K + S10 -> KS10 : a10*K*S10 - b10*KS10
               KS10 -> K + S11 : c1011*KS10
               F + S01 -> FS01 : alpha01*F*S01 - beta01*FS01
               FS01 -> F + S00 : gamma0100*FS01
               F + S10 -> FS10 : alpha10*F*S10 - beta10*FS10
               FS10 -> F + S00 : gamma1000*FS10
               F + S11 -> FS11 : alpha11*F*S11 - beta11*FS11
               FS11 -> F + S01 : gamma1101*FS11
               FS11 -> F + S10 : gamma1110*FS11
               FS11 -> F + S00 : gamma1100*FS11""",
            {name: name for name in "KS00 KS01 KS10 FS01 FS10 FS11 K F S00 S01 S10 S11".split()},
        ),
    },
    # okadalabipr/cancer_modeling, Lipniacki2004/model: differential_equation.py, with the rates of param_const.py
    "nfkb": {
        "theirs": {
            "IKKn": "x1", "IKKa": "x2", "IKKi": "x3", "IKK_I": "x4", "IKK_IN": "x5", "N": "x6", "Nn": "x7", "A20": "x8", "A20t": "x9", "I": "x10",
            "In": "x11", "It": "x12", "IN": "x13", "INn": "x14", "cgent": "x15", "TR": "u1", "kprod": "k_prod", "kdeg": "k_deg", "a1": "0.5", "a2": "0.2",
            "a3": "1", "c1a": "5e-7", "c2a": "0", "c5a": "1e-4", "c6a": "2e-5", "c1": "5e-7", "c2": "0", "c3": "4e-4", "c4": "0.5", "kv": "5",
            "e1a": "5e-4", "c1c": "5e-7", "c2c": "0", "c3c": "4e-4",
        },
        "rates": equations(
            """x1 = kprod - kdeg*IKKn - TR*k1*IKKn
               x2 = TR*k1*IKKn - k3*IKKa - TR*k2*IKKa*A20 - kdeg*IKKa - a2*IKKa*I + t1*IKK_I - a3*IKKa*IN + t2*IKK_IN
               x3 = k3*IKKa + TR*k2*IKKa*A20 - kdeg*IKKi
               x4 = a2*IKKa*I - t1*IKK_I
               x5 = a3*IKKa*IN - t2*IKK_IN
               x6 = c6a*IN - a1*N*I + t2*IKK_IN - i1*N
               x7 = i1*kv*N - a1*In*Nn
               x8 = c4*A20t - c5*A20
               x9 = c2 + c1*Nn - c3*A20t
               x10 = -a2*IKKa*I - a1*I*N + c4a*It - c5a*I - i1a*I + e1a*In
               x11 = -a1*In*Nn + i1a*kv*I - e1a*kv*In
               x12 = c2a + c1a*Nn - c3a*It
               x13 = a1*I*N - c6a*IN - a3*IKKa*IN + e2a*INn
               x14 = a1*In*Nn - e2a*kv*INn
               x15 = c2c + c1c*Nn - c3c*cgent"""
        ),
        "outputs": ["Nn", "I + IN", "A20t", "IKKn + IKKa + IKKi", "IKKa", "It"],
    },
    # GenSSI, Pharmacokinetics.m
    "pharm": {
        "theirs": {"y1": "x0", "y2": "x1", "y3": "x2", "y4": "x3", "vm": "n"},
        "rates": equations(
            """x0 = a1*(y2 - y1) - ka*vm*y1/(kc*ka + kc*y3 + ka*y1)
               x1 = a2*(y1 - y2)
               x2 = b1*(y4 - y3) - kc*vm*y3/(kc*ka + kc*y3 + ka*y1)
               x3 = b2*(y3 - y4)"""
        ),
    },
    # jgalfaro/mirrored-quadruple-tank, Simulations/PCSMatlab/QuadrupleTank.m: outlets o, gravity G
    "quadruple_tank": {
        "free": "o1 o2 o3 o4 G",
        "ours": {f"a{i}": f"o{i}*sqrt(2*G)" for i in range(1, 5)},
        "rates": equations(
            """h1 = -o1/A1*sqrt(2*G*h1) + o3/A1*sqrt(2*G*h3) + g1*k1/A1*v1
               h2 = -o2/A2*sqrt(2*G*h2) + o4/A2*sqrt(2*G*h4) + g2*k2/A2*v2
               h3 = -o3/A3*sqrt(2*G*h3) + (1 - g2)*k2/A3*v2
               h4 = -o4/A4*sqrt(2*G*h4) + (1 - g1)*k1/A4*v1"""
        ),
        "outputs": ["h1", "h2"],
    },
    # Sable/mcbench-benchmarks, 13556-continuously-stirred-tank-reactor-cstr/cstr1.m, after M. Henson and D. Seborg, Nonlinear Process Control (1997)
    "stirred_tank": {
        "free": "flow V mdelH rho Cp UA",
        "ours": {"q": "flow/V", "H": "mdelH/(rho*Cp)", "U": "UA/(V*rho*Cp)"},
        "rates": equations(
            """C = flow/V*(Cf - C) - k*exp(-E/T)*C
               T = flow/V*(Tf - T) + mdelH/(rho*Cp)*k*exp(-E/T)*C + UA/V/rho/Cp*(Tc - T)"""
        ),
    },
    # upb-lea/gym-electric-motor, docs, squirrel cage induction motor
    "induction_motor": {
        "free": "Rs Rr Lm ls lr va vb",
        "ours": {
            "Ls": "Lm + ls", "Lr": "Lm + lr", "sigma": "(Lr*Ls - Lm^2)/(Lr*Ls)", "gamma": "(Rs + Rr*Lm^2/Lr^2)/(sigma*Ls)", "k": "Lm/(sigma*Lr*Ls)",
            "g": "Rr/Lr", "m": "Lm*Rr/Lr", "ua": "va/(sigma*Ls)", "ub": "vb/(sigma*Ls)",
        },
        "theirs": {"tau": "sigma*Ls/(Rs + Rr*Lm^2/Lr^2)"},
        "rates": equations(
            """ia = -ia/tau + Rr*Lm/(sigma*Lr^2*Ls)*pa + omega*Lm/(sigma*Lr*Ls)*pb + va/(sigma*Ls)
               ib = -ib/tau - omega*Lm/(sigma*Lr*Ls)*pa + Rr*Lm/(sigma*Lr^2*Ls)*pb + vb/(sigma*Ls)
               pa = Lm*Rr/Lr*ia - Rr/Lr*pa - omega*pb
               pb = Lm*Rr/Lr*ib + omega*pa - Rr/Lr*pb"""
        ),
    },
    # upb-lea/gym-electric-motor, docs, permanent magnet synchronous motor with both inductances equal: in the rotor's frame, turned back here
    "pmsm_standstill": {
        "theirs": {
            "c": "cos(theta)", "s": "sin(theta)", "id": "ia*cos(theta) + ib*sin(theta)", "iq": "ib*cos(theta) - ia*sin(theta)",
            "rd": "(ua*cos(theta) + ub*sin(theta) + omega*L0*(ib*cos(theta) - ia*sin(theta)) - R*(ia*cos(theta) + ib*sin(theta)))/L0",
            "rq": "(ub*cos(theta) - ua*sin(theta) - omega*(L0*(ia*cos(theta) + ib*sin(theta)) + psi) - R*(ib*cos(theta) - ia*sin(theta)))/L0",
        },
        "rates": equations(
            """ia = c*rd - s*rq - omega*(s*id + c*iq)
               ib = s*rd + c*rq + omega*(c*id - s*iq)
               theta = omega"""
        ),
    },
    # drdv/bmsd, examples/planar2dof.m: H*accelerations + C = torques, solved by Cramer's rule
    "two_link_arm": {
        "theirs": {
            "h11": "r1^2*m1 + i1 + m2*l^2 + 2*m2*l*r2*cos(q2) + m2*r2^2 + i2", "h12": "m2*l*r2*cos(q2) + m2*r2^2 + i2", "h22": "m2*r2^2 + i2",
            "z1": "t1 - (cos(q1 + q2)*r2*m2*g + cos(q1)*r1*m1*g + cos(q1)*l*m2*g - 2*l*m2*w1*w2*r2*sin(q2) - l*m2*w2^2*r2*sin(q2))",
            "z2": "t2 - (cos(q1 + q2)*r2*m2*g + r2*m2*w1^2*l*sin(q2))",
        },
        "rates": equations(
            """q1 = w1
               q2 = w2
               w1 = (h22*z1 - h12*z2)/(h11*h22 - h12^2)
               w2 = (h11*z2 - h12*z1)/(h11*h22 - h12^2)"""
        ),
    },
    # albertoZurini/magi, 1_semestre/data_driven/hands_on/1stHandsOn/cart_pend.m, without friction
    "cart_pole": {
        "theirs": {"turn": "(g*sin(phi) + cos(phi)*(-F - m*l*omega^2*sin(phi))/(M + m))/(l*(4/3 - m*cos(phi)^2/(M + m)))"},
        "rates": equations(
            """x = v
               v = (F + m*l*(omega^2*sin(phi) - turn*cos(phi)))/(M + m)
               phi = omega
               omega = turn"""
        ),
    },
    # a public script, ChuaCircCN: Chua's circuit with a cubic nonlinearity, h(x) = p*x + q*x^3
    "chua": {
        "free": "p q",
        "ours": {"a": "q", "c": "1 + p"},
        "rates": equations("x = alpha*(-x + y - (p*x + q*x^3))\ny = x - y + z\nz = -beta*y"),
    },
    # montanariarthur/NonlinearObservability, systems/lorenz.m
    "lorenz": {"rates": equations("x = sigma*(y - x)\ny = rho*x - y - x*z\nz = x*y - beta*z"), "outputs": ["x"]},
    # L. Aguirre's script for these papers, and montanariarthur/NonlinearObservability, example_rossler.m
    "roessler": {"rates": equations("x = -y - z\ny = x + a*y\nz = b + z*(x - c)"), "outputs": ["y"]},
}


def differences(name, source, seed=1):
    """What is not the same: names of states, and places of outputs."""
    model, rng, found = ProofFile((BENCHMARKS / f"{name}.proof").read_text()), random.Random(seed), set()
    inputs = [rates for role, rates in model.fields if role == "input"]
    for _ in range(STATES):
        constants = [node[1] for node in model.nodes if node[0] == "constant" and node[1] != "pi"]
        drawn = [*model.states, *constants, *model.signals, *source.get("free", "").split(), *(f"u{i + 1}" for i in range(len(inputs)))]
        ours = {one: rng.uniform(0.5, 2) for one in drawn}
        for one, text in source.get("ours", {}).items():
            ours[one] = value(text, ours)
        theirs = ours | {one: value(text, ours) for one, text in source.get("theirs", {}).items()}
        numbers = []
        for operation, *of in model.nodes:
            if operation == "number":
                numbers.append(float(of[0]))
            elif operation in ("state", "constant", "signal"):
                numbers.append(ours[model.states[of[0]] if operation == "state" else of[0]])
            elif operation in MATH:
                numbers.append(MATH[operation](numbers[of[0]]))
            else:
                left, right = (numbers[place] for place in of)
                numbers.append({"+": left + right, "-": left - right, "*": left * right, "/": left / right if right else math.nan}[operation])
        same = lambda one, other: math.isclose(one, other, rel_tol=1e-11, abs_tol=1e-11)
        for state, text in source["rates"].items():
            rate = sum(numbers[rates[state]] for role, rates in model.fields if role == "drift" and state in rates)
            rate += sum(ours[f"u{i + 1}"] * numbers[rates[state]] for i, rates in enumerate(inputs) if state in rates)
            if not same(rate, value(text, theirs)):
                found.add(state)
        for place, text in enumerate(source.get("outputs", [])):
            if not same(numbers[model.outputs[place]], value(text, theirs)):
                found.add(f"output {place + 1}")
    return found


def main():
    names = sys.argv[1:] or sorted(SOURCES)
    wrong = 0
    for name in names:
        found = differences(name, SOURCES[name])
        wrong += bool(found)
        rates, outputs = len(SOURCES[name]["rates"]), len(SOURCES[name].get("outputs", []))
        print(f"{name}: {rates} rates, {outputs} outputs:", f"not the same: {', '.join(sorted(found))}" if found else "the same")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()

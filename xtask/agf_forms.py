#!/usr/bin/env python3
"""Writes crates/glass/tests/data/forms.agf: one medium for each formula number of glass catalog files (AGF).

Run from the root of the repository: python3 xtask/agf_forms.py > crates/glass/tests/data/forms.agf

The coefficients come from the refractiveindex.info database (CC0 1.0) and were rearranged by hand into the form of each formula. The
lines of the file are our own. nd and Vd are computed here, independently of the program. Media without an index in visible light
have nd 1 and Vd 0. No medium of the database uses Conrady's formula, so its three coefficients are fitted here to N-BK7 at the lines
h, d and A'.
"""

from math import sqrt

D, F, C = 0.5875618, 0.4861327, 0.6562725


def sellmeier(pairs, constant=1.0):
    return lambda um: sqrt(constant + sum(k * um * um / (um * um - m) for k, m in zip(pairs[::2], pairs[1::2])))


def powers(terms):
    return lambda um: sqrt(sum(c * um**p for c, p in terms))


def herzberger(c):
    def n(um):
        l = 1 / (um * um - 0.028)
        return c[0] + c[1] * l + c[2] * l * l + c[3] * um**2 + c[4] * um**4 + c[5] * um**6

    return n


BK7 = [1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653]


def conrady_through(n, wavelengths):
    rows = [[1.0, 1 / w, w**-3.5, n(w)] for w in wavelengths]
    for i in range(3):
        for j in range(3):
            if j != i:
                f = rows[j][i] / rows[i][i]
                rows[j] = [a - f * b for a, b in zip(rows[j], rows[i])]
    c = [float(f"{rows[i][3] / rows[i][i]:.10g}") for i in range(3)]
    return c, lambda um: c[0] + c[1] / um + c[2] * um**-3.5


def main():
    apl1 = [2.2762403, -0.0096874647, 0.0092330378, 0.00038940853, -3.8018733e-5, 2.0693225e-6]
    q19 = [3.22566311, -0.0126719158, -0.000122584245, 0.0306900263, 0.000649958511, 1.0629994e-5, 1.20774149e-6]
    kz1 = [2.54662904, -0.0122972332, 0.0187464623, 0.000460296583, 7.85351066e-7, 1.72720972e-6, -0.000133476806]
    silica = [0.565169763, 0.003823156, 0.422092787, 0.011444418, 0.11689465, 0.015169704, 0.883720207, 96.4254081]
    krs5 = [1.8293958, 0.0225, 1.6675593, 0.0625, 1.1210424, 0.1225, 0.04513366, 0.2025, 12.380234, 27089.737]
    silicon = [3.41983, 0.159906, -0.123109, 1.26878e-6, -1.95104e-9, 0.0]
    bbo = [2.7405, 0.0184, 0.0179, 0.0155]
    zno = [2.81418, 0.87968, 0.3042**2, 0.00711]
    aln = [3.1399, 1.3786, 0.1715**2, 3.861, 15.03**2]
    conrady, conrady_n = conrady_through(sellmeier(BK7), [0.4046561, D, 0.768195])
    # name, formula number, coefficients, n (None: no index in visible light), range in um
    media = [
        ("APL1", 1, apl1, powers(list(zip(apl1, [0, 2, -2, -4, -6, -8]))), (0.334, 2.325)),
        ("N-BK7", 2, BK7, sellmeier(BK7), (0.3, 2.5)),
        ("SI-EDWARDS", 3, silicon, None, (2.4373, 25)),
        ("BK7-CONRADY", 5, conrady, conrady_n, (0.4, 0.8)),
        ("NIFS-A", 6, silica, sellmeier(silica), (0.185, 2.325)),
        ("BBO-O", 7, bbo, lambda um: sqrt(bbo[0] + bbo[1] / (um**2 - bbo[2]) - bbo[3] * um**2), (0.22, 1.06)),
        ("ZNO-O", 8, zno, lambda um: sqrt(zno[0] + zno[1] * um**2 / (um**2 - zno[2]) - zno[3] * um**2), (0.45, 4)),
        ("ALN-O", 9, aln, sellmeier(aln[1:], aln[0]), (0.22, 5)),
        ("Q-LASFH19S", 13, q19, powers(list(zip(q19, [0, 2, 4, -2, -4, -6, -8]))), (0.365, 2.058)),
        ("KRS5", 11, krs5, None, (0.577, 39.38)),
        ("E-KZFH1", 12, kz1, powers(list(zip(kz1, [0, 2, -2, -4, -6, -8, 4]))), (0.4, 0.7)),
    ]
    print("CC Written by xtask/agf_forms.py. One medium a formula number; coefficients: refractiveindex.info database, CC0 1.0.")
    for name, number, coefficients, n, (low, high) in media:
        nd, vd = (n(D), (n(D) - 1) / (n(F) - n(C))) if n else (1.0, 0.0)
        print(f"NM {name} {number} 0 {nd:.6f} {vd:.4f} 0 0")
        print("CD " + " ".join(f"{c:.12g}" for c in coefficients))
        print(f"LD {low} {high}")


if __name__ == "__main__":
    main()

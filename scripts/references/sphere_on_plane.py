#!/usr/bin/env python3
"""Prints force against approach of a thin elastic sphere pressed on a rigid plane, by the theory of shallow shells.

Usage: scripts/references/sphere_on_plane.py      (needs numpy and scipy from PyPI)

With w the deflection towards the centre and F the membrane's stress function (N_r = F'/r, N_theta = F''):

    linear      D lap lap w - lap F / R = q                    lap lap F / (E t) = - lap w / R
    Marguerre   D lap lap w - (F' (r/R + w'))' / r = q         lap lap F / (E t) = - lap w / R - w' w'' / r
    l^4 = D R^2 / (E t)

In the contact, r < a, w = d - r^2 / (2 R). At r = a are continuous: w, w', w'' (no moment acts between shell and plane), F' and
F'' (membrane force and displacement). The plane may press with a line load along the rim. The equilibrium of the disc within
r > a gives the whole force P:

    r D (lap w)' - F' (r/R + w') = P / (2 pi)                  (linear: without w')

Linear, outside: w = A ker(r/l) + B kei(r/l), F = R D lap w + C ln r, P = -2 pi C / R; inside lap F = -(E t / R) w.
In x = r / l, w = (l^2 / R) omega, F' = (D / l) p, nothing is left of R, t and the material, also not from Marguerre's equations:

    x (lap omega)' - p (x + omega') = P R / (2 pi D)           x (p' + p / x)' = -(x omega' + omega'^2 / 2)

and in the contact p = x^3 / 16 + c x. The table holds a/l, d R / l^2, P R / D, and P over Reissner's point load
P = 4 E t^2 d / (R sqrt(3 (1 - nu^2))) = 8 D d / l^2, which is the linear limit a -> 0.

Sources: Reissner (1946), Stresses and small displacements of shallow spherical shells, J. Math. and Phys. 25 (point load);
Updike and Kalnins (1970), Axisymmetric behavior of an elastic spherical shell compressed between rigid plates, J. Appl. Mech.
37 (the contact problem, and that it loses its axial symmetry beyond about d = 2 t).
"""
import numpy as np
from scipy.integrate import solve_bvp
from scipy.special import kei, keip, ker, kerp

FAR = 40.0


def linear(alpha):
    """`(d R / l^2, P R / D)` by the linear theory where the contact's radius is `alpha` l."""
    # ker'' + ker'/x = -kei,  kei'' + kei'/x = ker
    ker2 = -kei(alpha) - kerp(alpha) / alpha
    kei2 = ker(alpha) - keip(alpha) / alpha
    a, b = np.linalg.solve([[kerp(alpha), keip(alpha)], [ker2, kei2]], [-alpha, -1.0])
    approach = a * ker(alpha) + b * kei(alpha) + alpha**2 / 2
    inside = approach * alpha / 2 - alpha**3 / 8
    lap_slope = -a * keip(alpha) + b * kerp(alpha)
    return approach, 2 * np.pi * alpha * (inside + lap_slope)


def marguerre(alphas, nonlinear=1.0):
    """The same by Marguerre's theory, for rising radii of the contact; `nonlinear` = 0 leaves the linear one."""
    rows = []
    x, y, force = None, None, np.zeros(1)
    for alpha in alphas:

        def slopes(x, y, parameters):
            _, theta, theta1, p, p1 = y
            shear = (parameters[0] / (2 * np.pi) + p * (x + nonlinear * theta)) / x
            stretch = -(x * theta + nonlinear * theta**2 / 2) / x
            return np.vstack(
                [theta, theta1, shear - theta1 / x + theta / x**2, p1, stretch - p1 / x + p / x**2]
            )

        def conditions(near, far, parameters):
            # (p' + p / x)' = x in the linear theory, x / 2 in Marguerre's: p = k x^3 + c x, and c is whatever it is.
            k = (1 - nonlinear / 2) / 8
            return np.array(
                [
                    near[1] + alpha,
                    near[2] + 1,
                    near[4] - near[3] / alpha - 2 * k * alpha**2,
                    far[0],
                    far[1],
                    far[4] + far[3] / FAR,
                ]
            )

        if x is None:
            x = alpha * (FAR / alpha) ** np.linspace(0, 1, 400)
            y = np.zeros((5, x.size))
        else:
            x = alpha + (x - x[0]) * (FAR - alpha) / (FAR - x[0])
        solution = solve_bvp(slopes, conditions, x, y, p=force, tol=1e-8, max_nodes=200000)
        assert solution.success, (alpha, solution.message)
        x, y, force = solution.x, solution.y, solution.p
        rows.append((y[0, 0] + alpha**2 / 2, force[0]))
    return rows


if __name__ == "__main__":
    alphas = [0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2]
    for name, rows in [
        ("linear, Kelvin functions", map(linear, alphas)),
        ("linear, boundary value problem", marguerre(alphas, 0.0)),
        ("Marguerre", marguerre(alphas)),
    ]:
        print(name)
        for alpha, (approach, force) in zip(alphas, rows):
            print(f"{alpha:6.2f} {approach:.6f} {force:.6f} {force / (8 * approach):.6f}")

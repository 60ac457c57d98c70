"""Geometrically nonlinear finite elements of one cell of the regular bistable pattern, pieces and ligaments alike.

An oracle for src/snap: plane stress, compressible neo-Hookean, modulus and thickness 1, Poisson's ratio 0.39, on a grid of
square elements whose stiffness is scaled by the part of them that is material. The cell's edges are mirror lines: points on
them keep a common coordinate across, which is free. A disc in the rectangle's middle is turned from 0 to -2 phi; printed
are the turn in degrees, the energy (over modulus x thickness), the torque and the cell's width.

    python3 snap_cell.py SIDE_MM RECTANGLE_SHARE PHI_DEG EXTRA_LENGTH_MM ELEMENT_MM STEPS
    python3 snap_cell.py 20 0.42 18 0 0.0625 12        the paper's notch: radius and width 0.5 mm
    python3 snap_cell.py 20 0.42 18 1 0.0625 12        1 mm longer

Needs numpy, scipy, shapely. 0.125 mm takes half a minute, 0.0625 mm some minutes. Not run by the test suite: the figures that
src/snap compares with are in its tests and in docs/snap.md.
"""

import sys

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.sparse.linalg import splu
from shapely.geometry import LineString
from shapely.ops import unary_union

WIDTH, RADIUS, POISSON = 0.5, 0.5, 0.39


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def grooves(side, a, phi, extra):
    """The grooves of the four slits: from the ligament at one corner of the rectangle past the next."""
    gap = WIDTH + 2 * RADIUS
    corners = (turned(phi) @ (np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * a / 2).T).T
    lines = []
    for i in range(4):
        angle = phi + np.arcsin(gap / 2 / a) + np.pi / 2 * (i - 2)
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        hinge = corners[(i + 1) % 4]
        start = hinge + along * (WIDTH / 2 + RADIUS)
        lines.append(LineString([start, hinge + along * 3 * side]))
        if extra > 0:
            lines.append(LineString([start - across * extra / 2, start + across * extra / 2]))
    return unary_union([line.buffer(RADIUS, 64) for line in lines])


class Cell:
    def __init__(self, side, a, phi, extra, h):
        n = int(round(side / h))
        h = side / n
        self.phi, self.side = phi, side
        fine = (np.arange(4 * n) + 0.5) * h / 4 - side / 2
        x, y = np.meshgrid(fine, fine)
        cut = grooves(side, a, phi, extra)
        shapely.prepare(cut)
        solid = ~shapely.contains_xy(cut, x.ravel(), y.ravel()).reshape(4 * n, 4 * n)
        density = solid.reshape(n, 4, n, 4).mean((1, 3))
        rows, columns = np.where(density > 0.3)
        first = rows * (n + 1) + columns
        used, numbers = np.unique(np.stack([first, first + 1, first + n + 2, first + n + 1], 1), return_inverse=True)
        self.elements = numbers.reshape(-1, 4)
        self.points = np.stack([(used % (n + 1)) * h - side / 2, (used // (n + 1)) * h - side / 2], 1)
        self.weight = h * h / 4 * density[rows, columns]
        xi, eta = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
        gauss = np.array([-1, 1]) / np.sqrt(3)
        self.slopes = [
            np.stack([xi * (1 + s * eta), eta * (1 + r * xi)], 1) / (2 * h) for r in gauss for s in gauss
        ]
        self.freedoms = np.repeat(2 * self.elements, 2, axis=1)
        self.freedoms[:, 1::2] += 1
        self.size = 2 * len(used)
        i, j = used % (n + 1), used // (n + 1)
        self.sides = [i == n, i == 0]
        master = -np.ones(self.size, int)
        for e, (mask, axis) in enumerate([(i == n, 0), (i == 0, 0), (j == n, 1), (j == 0, 1)]):
            master[2 * np.where(mask)[0] + axis] = e
        self.disc = (self.points**2).sum(1) < (a / 6) ** 2
        self.fixed = np.repeat(self.disc, 2)
        rest = (master < 0) & ~self.fixed
        master[rest] = 4 + np.arange(rest.sum())
        free = np.where(~self.fixed)[0]
        self.tie = sp.csr_matrix((np.ones(len(free)), (free, master[free])), shape=(self.size, 4 + rest.sum()))

    def energy(self, u, slopes=True):
        """Energy, force and stiffness at displacements u; infinite where an element is turned inside out."""
        mu, lam = 1 / (2 * (1 + POISSON)), POISSON / (1 - POISSON**2)
        moved = u.reshape(-1, 2)[self.elements]
        total, w = 0.0, self.weight
        force = np.zeros((len(moved), 8))
        stiff = np.zeros((len(moved), 8, 8)) if slopes else None
        for d in self.slopes:
            f = np.einsum("eai,aj->eij", moved, d) + np.eye(2)
            det = f[:, 0, 0] * f[:, 1, 1] - f[:, 0, 1] * f[:, 1, 0]
            if det.min() <= 0:
                return np.inf, None, None
            log = np.log(det)
            total += (w * (mu / 2 * ((f**2).sum((1, 2)) - 2 - 2 * log) + lam / 2 * log**2)).sum()
            if not slopes:
                continue
            g = np.stack([f[:, 1, 1], -f[:, 1, 0], -f[:, 0, 1], f[:, 0, 0]], 1).reshape(-1, 2, 2) / det[:, None, None]
            stress = mu * (f - g) + lam * log[:, None, None] * g
            force += w[:, None] * np.einsum("eij,aj->eai", stress, d).reshape(-1, 8)
            gd = np.einsum("eij,aj->eai", g, d)
            flat = gd.reshape(-1, 8)
            cross = np.einsum("ebi,eak->eaibk", gd, gd).reshape(-1, 8, 8) * (mu - lam * log)[:, None, None]
            plain = mu * np.einsum("ab,ik->aibk", d @ d.T, np.eye(2)).reshape(8, 8)
            stiff += w[:, None, None] * (lam * flat[:, :, None] * flat[:, None, :] + cross + plain)
        if not slopes:
            return total, None, None
        rows, columns = np.repeat(self.freedoms, 8, axis=1).ravel(), np.tile(self.freedoms, (1, 8)).ravel()
        matrix = sp.csr_matrix((stiff.ravel(), (rows, columns)), shape=(self.size, self.size))
        return total, np.bincount(self.freedoms.ravel(), force.ravel(), self.size), matrix

    def solve(self, stiff, right):
        matrix = (self.tie.T @ stiff @ self.tie).tocsc()
        options = {"SymmetricMode": True}
        return self.tie @ splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=options).solve(right)

    def at(self, u, before, angle, first):
        """Displacements of least energy with the disc at an angle, from those of the last two angles."""
        at = self.points[self.disc]
        target = (at @ turned(angle).T - at).ravel()
        new = 2 * u - before
        if first:
            push = np.zeros(self.size)
            push[self.fixed] = target
            stiff = self.energy(u)[2]
            new = u + push + self.solve(stiff, -self.tie.T @ (stiff @ push))
        new[self.fixed] = target
        for _ in range(25):
            total, force, stiff = self.energy(new)
            left = self.tie.T @ force
            if np.abs(left).max() < 1e-9:
                break
            step, part = self.solve(stiff, -left), 1.0
            while not np.isfinite(self.energy(new + part * step, False)[0]):
                part /= 2
            new = new + part * step
        now = self.points + new.reshape(-1, 2)
        f = force.reshape(-1, 2)
        torque = -(now[self.disc, 0] * f[self.disc, 1] - now[self.disc, 1] * f[self.disc, 0]).sum()
        width = now[self.sides[0], 0].mean() - now[self.sides[1], 0].mean()
        return new, total, torque, width


def main(side, share, phi_deg, extra, h, steps):
    phi = np.radians(phi_deg)
    cell = Cell(side, share * side, phi, extra, h)
    u = before = np.zeros(cell.size)
    print(f"# {cell.size} unknowns\n# turn_deg energy torque width")
    for step in range(1, int(steps) + 1):
        angle = -2 * phi * step / steps
        new, energy, torque, width = cell.at(u, before, angle, step == 1)
        u, before = new, u
        print(f"{-np.degrees(angle):.2f} {energy:.6f} {torque:.6f} {width:.4f}", flush=True)


if __name__ == "__main__":
    main(*map(float, sys.argv[1:7]))

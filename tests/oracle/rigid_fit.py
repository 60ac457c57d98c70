"""How rigid a design of another program is: rigid_fit.py --obj CLOSED OPEN | --pykirigami FOLDER

Reads the files by itself and fits each piece with a rotation from a singular value decomposition. Prints one line of JSON:
  pieces            number of pieces
  hinges            pairs of corners of different pieces that coincide in both states to 1e-6 mean sides
  rigid_residual    largest distance that the best rigid motion of a piece leaves, in mean sides of the closed pieces
  worst_piece       the piece of that distance, counted from 0
  max_length_error  largest relative difference of a distance within a piece
"""

import json
import sys
from pathlib import Path

import numpy as np


def read_obj(path):
    vertices, faces = [], []
    for line in Path(path).read_text().splitlines():
        words = line.split()
        if words and words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words and words[0] == "f":
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return [np.array([vertices[v] for v in face]) for face in faces]


def read_rows(path):
    lines = [line for line in Path(path).read_text().splitlines() if line.strip()]
    return [np.array([float(word) for word in line.split()]).reshape(-1, 3) for line in lines]


def misfit(start, end):
    p, q = start - start.mean(axis=0), end - end.mean(axis=0)
    u, _, vt = np.linalg.svd(p.T @ q)
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    return np.linalg.norm(p @ turn - q, axis=1).max()


def pairs(points):
    rows, columns = np.triu_indices(len(points), 1)
    return np.linalg.norm(points[rows] - points[columns], axis=1)


def main():
    if sys.argv[1] == "--obj":
        closed, opened = read_obj(sys.argv[2]), read_obj(sys.argv[3])
    else:
        folder = Path(sys.argv[2])
        closed, opened = read_rows(folder / "vertices.txt"), read_rows(folder / "target.txt")
    sides = [np.linalg.norm(piece - np.roll(piece, 1, axis=0), axis=1) for piece in closed]
    side = np.concatenate(sides).mean()
    left = np.array([misfit(p, q) for p, q in zip(closed, opened, strict=True)]) / side
    owner = np.concatenate([[i] * len(piece) for i, piece in enumerate(closed)])
    apart = [np.linalg.norm((row := np.concatenate(state))[:, None] - row[None], axis=2) for state in (closed, opened)]
    together = np.maximum(*apart) < 1e-6 * side
    hinges = (together & (owner[:, None] < owner[None])).sum()
    errors = [np.abs(pairs(p) - pairs(q)) / pairs(p) for p, q in zip(closed, opened, strict=True)]
    print(
        json.dumps(
            {
                "pieces": len(closed),
                "hinges": int(hinges),
                "rigid_residual": float(left.max()),
                "worst_piece": int(left.argmax()),
                "max_length_error": float(np.concatenate(errors).max()),
            }
        )
    )


main()

"""Power diagrams (Laguerre tessellations) of a rectangle whose cells have given areas.

The cell of site i is where |x - x_i|^2 - w_i is least. Weights w for which the cells have given
areas are found by Newton's method, whose steps are halved until no cell vanishes: Kitagawa, Merigot
& Thibert (2019), J. Eur. Math. Soc. 21, 2603-2651. Sites that move to the centroids of their cells
in turn with that make the cells round: Bourne, Kok, Roper & Spanjer (2020), Phil. Mag. 100,
2677-2707.
"""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial import ConvexHull


class Diagram:
    """Cells of sites x n x 2 with weights w n in the rectangle (x0, y0, x1, y1).

    corners m x 2, sorted about each cell's site counter-clockwise, cell i has the rows
    first[i]:first[i + 1]; area n, centroid n x 2, perimeter n. The lower hull of the points
    (x, |x|^2 - w) is the dual; mirrored sites end the cells at the walls.
    """

    def __init__(self, x, w, rectangle):
        n = len(x)
        sites, weights = mirrored(x, w, rectangle)
        origin = x.mean(axis=0)
        at = sites - origin
        hull = ConvexHull(np.column_stack([at, (at**2).sum(axis=1) - weights]))
        lower = hull.equations[:, 2] < 0
        triangles = hull.simplices[lower]
        # The plane z = 2 c.x + const through three lifted points touches at the cells' corner c.
        corner = -hull.equations[lower, :2] / hull.equations[lower, 2:3] / 2 + origin
        cell = triangles.ravel()
        corner_of = np.repeat(np.arange(len(triangles)), 3)
        mine = cell < n
        cell, corner_of = cell[mine], corner_of[mine]
        count = np.bincount(cell, minlength=n)
        self.complete = bool(np.all(count >= 3))
        if not self.complete:
            return
        middle = np.column_stack([np.bincount(cell, corner[corner_of, k], n) / count
                                  for k in (0, 1)])
        arm = corner[corner_of] - middle[cell]
        order = np.lexsort((np.arctan2(arm[:, 1], arm[:, 0]), cell))
        self.cell, corner_of = cell[order], corner_of[order]
        self.first = np.concatenate([[0], np.cumsum(count)])
        self.corners = corner[corner_of]
        after = np.arange(len(self.cell)) + 1  # the row of the next corner
        after[self.first[1:] - 1] = self.first[:-1]
        a, b = self.corners - middle[self.cell], self.corners[after] - middle[self.cell]
        cross = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
        self.area = np.bincount(self.cell, cross, n)
        self.complete = bool(np.all(self.area > 0))
        if not self.complete:
            return
        self.centroid = middle + np.column_stack(
            [np.bincount(self.cell, cross * (a + b)[:, k] / 3, n) for k in (0, 1)]
        ) / self.area[:, None]
        self.perimeter = np.bincount(self.cell, np.hypot(*(b - a).T), n)
        # Edges between cells: of two triangles that share the two cells' sites.
        number = np.cumsum(lower) - 1
        beside = hull.neighbors[lower]
        pair = np.stack([triangles[:, [1, 2]], triangles[:, [2, 0]], triangles[:, [0, 1]]], axis=1)
        this = np.repeat(np.arange(len(triangles)), 3).reshape(-1, 3)
        once = lower[beside] & (number[beside] > this) & (pair < n).all(axis=2)
        self.pairs, self.distance = pair[once], np.hypot(*(x[pair[once][:, 1]]
                                                           - x[pair[once][:, 0]]).T)
        self.between = np.hypot(*(corner[number[beside[once]]] - corner[this[once]]).T)

    def cells(self):
        """Corners of each cell."""
        return np.split(self.corners, self.first[1:-1])

    def derivative(self):
        """Of areas by weights, sparse n x n: minus length / (2 distance) across each edge, and the
        sum of those on the diagonal."""
        n, (i, j) = len(self.area), self.pairs.T
        value = self.between / (2 * np.maximum(self.distance, 1e-300))
        return coo_matrix((np.concatenate([value, value, -value, -value]),
                           (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))),
                          shape=(n, n)).tocsc()


def mirrored(x, w, rectangle):
    """Sites and weights with their images behind the four walls; those of far sites bound no cell.
    """
    x0, y0, x1, y1 = rectangle
    spacing = np.sqrt((x1 - x0) * (y1 - y0) / len(x))
    reach = 3 * spacing + 3 * np.sqrt(np.maximum(w - w.min(), 0).max())
    sites, owners = [x], [np.arange(len(x))]
    for axis, wall in ((0, x0), (0, x1), (1, y0), (1, y1)):
        near = np.flatnonzero(np.abs(x[:, axis] - wall) < reach)
        image = x[near].copy()
        image[:, axis] = 2 * wall - image[:, axis]
        sites.append(image)
        owners.append(near)
    owner = np.concatenate(owners)
    return np.concatenate(sites), w[owner]


def with_areas(x, w, target, rectangle, accuracy, steps=60):
    """The diagram whose cells have the areas `target` n to a relative `accuracy`, and its weights;
    None if Newton's method from w does not get there."""
    diagram = Diagram(x, w, rectangle)
    if not diagram.complete:
        return None
    for _ in range(steps):
        error = target - diagram.area
        if np.abs(error / target).max() < accuracy:
            return diagram, w
        matrix = diagram.derivative()[1:, 1:]  # a constant added to all weights changes nothing
        step = np.concatenate([[0], spsolve(matrix, error[1:])])
        least = 0.3 * min((diagram.area / target).min(), 1)
        part = 1.0
        while True:
            new = w + part * step
            trial = Diagram(x, new - new.mean(), rectangle)
            if trial.complete and (trial.area / target).min() > least and np.linalg.norm(
                    target - trial.area) < (1 - part / 4) * np.linalg.norm(error):
                break
            part /= 2
            if part < 1e-4:
                return None
        diagram, w = trial, new - new.mean()
    return None


def round_cells(x, radius, diameter, rectangle, rounds=6):
    """Cells whose mean calliper diameters are as `diameter` n to each other: (diagram, largest
    relative deviation from that). x n x 2: centres of discs of this radius n that do not overlap,
    from which all cells are there."""
    x0, y0, x1, y1 = rectangle
    whole = (x1 - x0) * (y1 - y0)
    w = radius**2 - (radius**2).mean()
    form = np.ones(len(x))  # area over the square of the diameter, but for a factor
    for k in range(rounds):
        target = form * diameter**2
        target *= whole / target.sum()
        found = with_areas(x, w, target, rectangle, 1e-3 if k < rounds - 1 else 1e-6)
        if found is None:
            return None
        diagram, w = found
        calliper = diagram.perimeter / np.pi
        form = target / calliper**2
        if k < rounds - 1:
            moved = diagram.centroid
            if Diagram(moved, w, rectangle).complete:
                x = moved
    return diagram

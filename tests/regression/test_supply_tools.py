#!/usr/bin/python3
"""The tools on a run in which ice joins and leaves: the numbers of each are those of the frames and
of the account in history.csv."""
import json
import sys
import unittest

import h5py
import matplotlib
import numpy as np

from launch import REPOSITORY
from supply_runs import SupplyTools, tool

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import plots  # noqa: E402
from floe.loads import fields, statements  # noqa: E402
from floe.report.arrays import unpack  # noqa: E402
from floe.report.page import data_in  # noqa: E402
from floe.results import breakage  # noqa: E402
from floe.results.output import matrices, rotations  # noqa: E402

matplotlib.use("Agg")


def polygon_volume(points, faces):
    """Volume of one convex body by tetrahedra from its first point."""
    total = 0.0
    for face in faces:
        a = points[face[0]] - points[0]
        for i, j in zip(face[1:-1], face[2:]):
            total += np.dot(a, np.cross(points[i] - points[0], points[j] - points[0])) / 6
    return total


class Tools(SupplyTools):
    def test_plots(self):
        for when in self.output.times[[0, 3, 4, -1]]:
            figure = plots.sheet(self.output, when, "ux", True, 1).figure
            count = int(self.account.at(when)["bodies"])
            tiles = figure.axes[0].collections[0]
            self.assertEqual(len(tiles.get_paths()), count)
            unit = 1 if "[m]" in figure.axes[1].get_ylabel() else 1e-3
            np.testing.assert_allclose(tiles.get_array() * unit,
                                       self.output.field("bodies_displacement", when)[:, 0])
            axial, _ = self.output.beam_stress("axial", when)
            force = self.output.field("beams_force", when)[:, 0]
            tensile, moment = (self.output.field(name, when) for name in (
                "beams_stress", "beams_moment"))
            beams = self.output.at(when).beams
            bent = (np.abs(moment[:, 1]) * beams["height"] / 2 / beams["inertia_y"]
                    + np.abs(moment[:, 2]) * beams["width"] / 2 / beams["inertia_z"])
            np.testing.assert_allclose(axial + bent, tensile[:, 0], rtol=1e-9, atol=1e-6)
            np.testing.assert_allclose(axial, force / beams["area"])
            axes = plots.fragments(self.output, when)
            self.assertEqual(len(axes.collections[0].get_paths()), count)
            matplotlib.pyplot.close("all")
        for words in (["plot_sheet", self.made, "--time", 2, "--deformed", 1],
                      ["plot_fragments", self.made, "--time", 2], ["plot_load", self.made]):
            tool(*words, "--file", self.folder / "p.png")
        said = tool("plot_deflection", self.made, code=2)
        self.assertEqual(said.count("\n"), 1)
        self.assertIn("supply", said)

    def test_loads(self):
        """Fragments of the last frame without the sheet, a pile of its bodies' volumes."""
        tool("loads", self.made, "--fields", "--start", 1)
        (found,) = json.loads((self.made / "loads.json").read_text())
        end = self.account.at(5)
        self.assertEqual(found["ice"]["fragments"]["number"], end["fragments"] - 1)
        self.assertGreater(len(found["ice"]["pressure_area"]["area"]), 2)
        # columns over all ice hold its volume
        bodies = fields.Bodies(self.output, 5)
        self.assertEqual(len(bodies), end["bodies"])
        spacing = 0.1
        low, high = bodies.low.min(axis=0), bodies.high.max(axis=0)
        _, top, bottom, solid = fields.columns(bodies, spacing, (low[:2], high[:2]))
        shapes = self.output.at(5).shapes
        volume = sum(polygon_volume(bodies.points, [
            shapes["corners"][shapes["corner_of"][f]:shapes["corner_of"][f + 1]]
            for f in range(*shapes["face_of"][b:b + 2])]) for b in range(len(bodies)))
        self.assertAlmostEqual(volume * 920 / end["mass"], 1, 9)
        # overlaps of contacts count once
        self.assertAlmostEqual(solid.sum() * spacing**2 / volume, 1, delta=0.03)
        self.assertTrue(np.all(top - bottom > solid - 1e-3))
        self.assertEqual(len(statements.read_run(self.made).forces), 1)

    def test_netcdf(self):
        import xarray
        tool("netcdf", self.made, "--bodies")
        with xarray.open_dataset(self.made / "run.nc") as data:
            one = data.isel(run=0)
            self.assertEqual(one["mass_supplied"].attrs["units"], "kg")
            self.assertEqual(one["momentum_removed_x"].attrs["units"], "kg m s-1")
            np.testing.assert_allclose(one["bodies"], self.account.rows["bodies"])
            mass = one["fragment_mass"].values
            self.assertEqual(np.sum(~np.isnan(mass)), self.account.at(5)["fragments"])
            self.assertAlmostEqual(np.nansum(mass) / self.account.at(5)["mass"], 1, 9)
            np.testing.assert_array_equal(one["frame_time"], self.output.times)
            for k, when in enumerate(self.output.times):
                there = ~np.isnan(one["body_position"].values[k, :, 0])
                ice, wanted = self.output.at(when), self.account.at(when)
                np.testing.assert_array_equal(one["body"].values[there], ice.names)
                np.testing.assert_array_equal(one["body_position"].values[k, there],
                                              self.output.field("centres", when))
                self.assertAlmostEqual(one["body_mass"].values[there].sum() / wanted["mass"], 1, 9)
                piece = one["body_fragment"].values[k]
                self.assertEqual(len(np.unique(piece[there])), wanted["fragments"])
                self.assertTrue(np.all(np.isnan(piece[~there])))

    def step_of(self, root, k):
        """Points, polygons (offsets, corners) and where cell data begin, as VTK's reader finds
        them: offsets of a mesh have one number more than its polygons."""
        steps = root["Steps"]
        part = steps["PartOffsets"][k]
        cells = root["Polygons/NumberOfCells"][part]
        before = steps["CellOffsets"][k, 2]
        # it counts the meshes before by their polygons
        counted, number = 0, 0
        while number < before:
            number += root["Polygons/NumberOfCells"][counted]
            counted += 1
        self.assertEqual((counted, number), (part, before))
        offsets = root["Polygons/Offsets"][before + part:before + part + cells + 1]
        first = steps["ConnectivityIdOffsets"][k, 2]
        count = root["Polygons/NumberOfConnectivityIds"][part]
        corners = root["Polygons/Connectivity"][first:first + count]
        self.assertEqual((offsets[0], offsets[-1]), (0, count))
        begin = steps["PointOffsets"][k]
        points = root["Points"][begin:begin + root["NumberOfPoints"][part]]
        self.assertEqual(len(points), corners.max() + 1)

        def of_cells(name):
            at = steps[f"CellDataOffsets/{name}"][k]
            return root[f"CellData/{name}"][at:at + cells]
        return points, offsets, corners, of_cells

    def test_vtkhdf(self):
        tool("vtkhdf", self.made)
        with h5py.File(self.made / "bodies.vtkhdf") as file:
            root = file["VTKHDF"]
            for kind in ("Vertices", "Lines", "Strips"):
                self.assertFalse(np.any(root[f"{kind}/Offsets"]))
            for k, when in enumerate(self.output.times):
                points, offsets, corners, of_cells = self.step_of(root, k)
                np.testing.assert_allclose(points, self.output.field("points", when), atol=1e-5)
                body, wanted = of_cells("body"), self.account.at(when)
                self.assertEqual(len(np.unique(body)), wanted["bodies"])
                self.assertEqual(len(np.unique(of_cells("fragment"))), wanted["fragments"])
                np.testing.assert_allclose(of_cells("displacement"),
                                           self.output.field("face_displacement", when), rtol=1e-6)
                faces = np.split(corners, offsets[1:-1])
                volume = sum(polygon_volume(points.astype(float), [
                    faces[f] for f in np.flatnonzero(body == b)]) for b in np.unique(body)[:3])
                mass = self.output.at(when).mass[:3].sum()
                self.assertAlmostEqual(volume * 920 / mass, 1, 3)
        with h5py.File(self.made / "cracks.vtkhdf") as file:
            for k, when in enumerate(self.output.times):
                points, _, corners, of_cells = self.step_of(file["VTKHDF"], k)
                is_open = of_cells("open") == 1
                self.assertEqual(is_open.sum(), 2 * self.account.at(when)["beams_broken"])
                spread = np.ptp(points[corners].reshape(-1, 4, 3), axis=1).max(axis=1)
                np.testing.assert_array_equal(spread > 1e-6, is_open)
                np.testing.assert_array_equal(
                    np.unique(of_cells("beam")[is_open]),
                    np.flatnonzero(self.output.field("damage", when) >= 1))

    def test_report(self):
        tool("report", self.made)
        report = data_in((self.made / "report.html").read_text())
        scene = report["scene"]
        self.assertEqual(report["fragments"]["number"], self.account.at(5)["fragments"])
        self.assertEqual(report["fragments"]["broken"], self.account.at(5)["beams_broken"])
        self.bodies_come_and_go(scene)
        self.cracks_are_those_of_the_frames(scene)
        self.energies_balance(report)
        self.arrow_is_at_the_far_edge(scene)
        self.assertIn("111 bodies", dict(report["facts"])["ice that joined and left"])
        # with fewer frames: bodies that none of them has are left out
        tool("report", self.made, "--frames", 3, "--file", self.folder / "few.html")
        few = data_in((self.folder / "few.html").read_text())["scene"]
        ids = set(unpack(few["ids"])[0].tolist())
        self.assertEqual(ids, set(np.concatenate([self.output.at(t).names for t in few["times"]])))

    def bodies_come_and_go(self, scene):
        ids, life = unpack(scene["ids"])[0], unpack(scene["life"])
        poses, places = unpack(scene["poses"]), unpack(scene["places"])
        masses, step = np.array(scene["masses"]), scene["step"]
        a, b, ended = unpack(scene["beams"])
        counts = unpack(scene["counts"])
        owner = np.repeat(np.arange(scene["bodies"]), counts[0])
        corners = unpack(scene["corners"]).T * step
        for k, when in enumerate(scene["times"]):
            there = (life[0] <= k) & (k <= life[1])
            wanted, ice = self.account.at(when), self.output.at(when)
            np.testing.assert_array_equal(ids[there], ice.names)
            self.assertAlmostEqual(masses[there].sum() / wanted["mass"], 1, 4)
            place = (places + poses[k, :3]).T[there] * step + scene["origin"]
            np.testing.assert_allclose(place, self.output.field("centres", when),
                                       atol=0.5001 * step)
            np.testing.assert_allclose(poses[k, 3:].T[there] * scene["turn_step"],
                                       self.output.field("bodies_rotation", when), atol=6e-4)
            # corners of the bodies: form and pose together
            turn = rotations(poses[k, 3:].T * scene["turn_step"])
            world = (places + poses[k, :3]).T * step + scene["origin"]
            points = world[owner] + np.einsum("vij,vj->vi", turn[owner], corners)
            np.testing.assert_allclose(points[there[owner]], self.output.field("points", when),
                                       atol=3 * step)
            # pieces of what is there, as the page counts them
            whole = ((ended < 0) | (ended > 1000 * when)) & there[a] & there[b]
            piece = breakage.pieces(scene["bodies"], np.column_stack([a, b])[whole])
            self.assertEqual(len(np.unique(piece[there])), wanted["fragments"])

    def cracks_are_those_of_the_frames(self, scene):
        """Those on bodies that exist and that have broken by then, where the frame has them."""
        carrier, ended = unpack(scene["cracks"]["of"])
        corners = unpack(scene["cracks"]["corners"]).reshape(-1, 4, 3) * scene["step"]
        ids, life = unpack(scene["ids"])[0], unpack(scene["life"])
        for k, when in enumerate(scene["times"]):
            shown = (ended <= 1000 * when) & (life[0, carrier] <= k) & (k <= life[1, carrier])
            number = 2 * self.account.at(when)["beams_broken"]
            if not number:
                self.assertFalse(np.any(shown))
                continue
            ice = self.output.at(when)
            row = np.searchsorted(ice.names, ids[carrier[shown]])
            turn = matrices(quaternions(self.output.field("bodies_rotation", when)[row]))
            centre = self.output.field("centres", when)[row]
            placed = centre[:, None] + np.einsum("fij,fkj->fki", turn, corners[shown])
            middles = placed.mean(axis=1)
            quads = self.output.field("cracks", when)
            wanted = self.output.field("crack_points", when)[quads].mean(axis=1)
            near = np.linalg.norm(middles[:, None] - wanted[None], axis=2)
            # of beams to bodies that have left one face is here, in no frame that follows
            self.assertLessEqual(len(wanted), len(middles))
            self.assertLess(near.min(axis=0).max(), 2 * scene["step"])

    def energies_balance(self, report):
        rows = report["energies"]["rows"]
        total = {kind: sum(row["end"] for row in rows if row["kind"] == kind)
                 for kind in ("put in", "stored", "lost")}
        names = {row["name"]: row for row in rows}
        self.assertEqual(names["with ice that joined"]["kind"], "put in")
        self.assertEqual(names["with ice that left"]["kind"], "lost")
        self.assertAlmostEqual(total["put in"] - total["stored"] - total["lost"], 0,
                               delta=1.01 * report["energies"]["error"] + 1e-6)

    def arrow_is_at_the_far_edge(self, scene):
        """At the mean place of the bodies of the far edge, whichever strip is the last."""
        (arrow,) = [a for a in scene["arrows"] if a["kind"] == "boundary"]
        for when, at in zip(scene["times"], arrow["at"]):
            edge = self.output.at(when).sets["left"]
            np.testing.assert_allclose(np.array(at) + scene["origin"], self.output.field(
                "centres", when)[edge].mean(axis=0), atol=2e-3)


def quaternions(vectors):
    """Unit quaternions n x 4 of rotation vectors n x 3."""
    angle = np.linalg.norm(vectors, axis=1, keepdims=True)
    axis = vectors / np.maximum(angle, 1e-300)
    return np.hstack([np.cos(angle / 2), np.sin(angle / 2) * axis])


if __name__ == "__main__":
    unittest.main()

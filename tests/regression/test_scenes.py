#!/usr/bin/python3
"""Every scene of input/ runs by the command of its own first line and gives the numbers its header
promises.

A scene without an entry in EXPECTED fails; the checks are in scenes/, by subject. The commands run
in a temporary folder that looks like the repository, with floe on the PATH, so nothing is left
behind.
Commands on several ranks: test_scenes_ranks.py.
"""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import Output  # noqa: E402
from launch import ENVIRONMENT  # noqa: E402
from scenes import beams, contact, fracture, moving, static, structures  # noqa: E402

EXPECTED = {
    "ice_slope.yaml": structures.check_ice_slope,
    "endless_slope.yaml": structures.check_endless_slope,
    "monopile_lockin.yaml": structures.check_monopile_lockin,
    "bridge_pier.yaml": structures.check_bridge_pier,
    "moored_floater.yaml": structures.check_moored_floater,
    "ship.yaml": structures.check_ship,
    "towed_floe.yaml": structures.check_towed_floe,
    "ice_cone.yaml": structures.check_ice_cone,
    "ice_cylinder.yaml": structures.check_ice_cylinder,
    "ice_vibration.yaml": structures.check_ice_vibration,
    "verify/ice_slope.yaml": structures.check_ice_slope_strip,
    "shear_box_pour.yaml": contact.check_shear_box_pour,
    "shear_box.yaml": contact.check_shear_box,
    "rafting.yaml": structures.check_rafting,
    "ridge_building.yaml": structures.check_ridge_building,
    "ridge_on_leg.yaml": structures.check_ridge_on_leg,
    "keel_punch.yaml": structures.check_keel_punch,
    "punch_through.yaml": contact.check_punch_through,
    "floes_collide.yaml": contact.check_floes_collide,
    "floe_in_waves.yaml": moving.check_floe_in_waves,
    "real_floe.yaml": contact.check_real_floe,
    "touching_floes.yaml": contact.check_touching_floes,
    "floe_field.yaml": contact.check_floe_field,
    "rubble_pile.yaml": contact.check_rubble_pile,
    "verify/stopping.yaml": contact.check_stopping,
    "verify/local_pressure.yaml": contact.check_local_pressure,
    "uneven_sheet.yaml": static.check_uneven_sheet,
    "break_strip.yaml": fracture.check_break_strip,
    "in_situ_cantilever.yaml": fracture.check_in_situ_cantilever,
    "edge_uplift.yaml": fracture.check_edge_uplift,
    "strength_tension.yaml": fracture.check_strength_tension,
    "strength_bending.yaml": fracture.check_strength_bending,
    "point_breakthrough.yaml": fracture.check_point_breakthrough,
    "notch.yaml": fracture.check_notch,
    "tension.yaml": static.check_tension,
    "bending.yaml": static.check_bending,
    "compression.yaml": static.check_compression,
    "biaxial.yaml": static.check_biaxial,
    "shear.yaml": static.check_shear,
    "slide.yaml": static.check_slide,
    "edge_load.yaml": static.check_edge_load,
    "tension_calibrated.yaml": static.check_tension_calibrated,
    "bending_calibrated.yaml": static.check_bending_calibrated,
    "tension_explicit.yaml": moving.check_tension_explicit,
    "bending_explicit.yaml": moving.check_bending_explicit,
    "tension_implicit.yaml": moving.check_tension_implicit,
    "bending_implicit.yaml": moving.check_bending_implicit,
    "verify/free_top.yaml": beams.check_free_top,
    "verify/rk_top.yaml": beams.check_rk_top,
    "verify/rk_drag.yaml": moving.check_rk_drag,
    "verify/free_flight.yaml": beams.check_free_flight,
    "verify/vibrating.yaml": beams.check_vibrating,
    "verify/wave.yaml": beams.check_wave,
    "bench/largest.yaml": static.check_largest,
    "bench/explicit.yaml": moving.check_explicit_bench,
    "bench/largest_explicit.yaml": moving.check_largest_explicit,
    "verify/bend45.yaml": beams.check_bend45,
    "verify/bend45_softer.yaml": beams.check_bend45_softer,
    "verify/rollup.yaml": beams.check_rollup,
    "verify/elastica.yaml": beams.check_elastica,
    "verify/lee_frame.yaml": beams.check_lee_frame,
    "verify/arch.yaml": beams.check_arch,
    "verify/notch_snap_back.yaml": fracture.check_notch_snap_back,
    "verify/triangles_tension.yaml": static.check_triangles_tension,
    "verify/triangles_shear.yaml": static.check_triangles_shear,
    "verify/triangles_bulk.yaml": static.check_triangles_bulk,
    "verify/heave.yaml": moving.check_heave,
    "verify/drag_decay.yaml": moving.check_drag_decay,
    "verify/yaw_decay.yaml": moving.check_yaw_decay,
}


class SceneTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/floe").symlink_to(FLOE)
        (self.folder / "input").symlink_to(REPOSITORY / "input")
        self.environment = dict(ENVIRONMENT, PATH=f"{self.folder}/bin:{os.environ['PATH']}")

    def runner(self, scene):
        """A function that runs the scene's own command, with more options if given: its output.
        status: the exit code, or those that may be."""
        first = scene.read_text().splitlines()[0]
        self.assertTrue(first.startswith("# ")
                        and first.endswith(f"input/{scene.relative_to(REPOSITORY / 'input')}"),
                        f"{scene}: the first line must be the command that runs it")

        def run(*options, ranks=1, status=0):
            command = " ".join([*(["mpiexec", "-n", str(ranks)] if ranks > 1 else []), first[2:],
                                *options])
            done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment,
                                  capture_output=True,
                                  text=True)
            self.assertIn(done.returncode, status if isinstance(status, tuple) else (status,),
                          f"{command}\n{done.stdout}{done.stderr}")
            return Output(self.folder / "out" / scene.stem)

        return run


def add_tests(case, on_ranks):
    """One test per scene, named after it: those whose command is for several ranks, or the
    others."""
    for scene in sorted((REPOSITORY / "input").rglob("*.yaml")):
        name = str(scene.relative_to(REPOSITORY / "input"))
        if name.startswith("ensembles/"):
            continue  # specs: test_ensemble.py

        def test(self, scene=scene, name=name):
            self.assertIn(name, EXPECTED, "a scene needs an entry in EXPECTED")
            EXPECTED[name](self, self.runner(scene))

        if scene.read_text().startswith("# mpiexec") == on_ranks:
            setattr(case, "test_" + name.removesuffix(".yaml").replace("/", "_"), test)


class Scenes(SceneTest):
    pass


add_tests(Scenes, on_ranks=False)

if __name__ == "__main__":
    unittest.main()

"""A small run that tests of reports share: a sheet that breaks at a cone."""
import subprocess
import sys

from launch import ENVIRONMENT, FLOE, REPOSITORY

SMALL = ("-sheet_length", "16", "-sheet_width", "10", "-sheet_element_size", "2",
         "-obstacle_cone_base", "12.2, 0, -4", "-time_end", "6", "-output_fields", "0.25")


def run_cone(folder, *options):
    """Runs it into a folder."""
    done = subprocess.run([FLOE, REPOSITORY / "input/ice_cone.yaml", *SMALL, *options,
                           "-output_dir", folder], capture_output=True, text=True, env=ENVIRONMENT)
    assert done.returncode == 0, done.stdout + done.stderr


def make_report(*words, code=0):
    """Runs floe report; its words."""
    done = subprocess.run([sys.executable, REPOSITORY / "tools/report", *map(str, words)],
                          capture_output=True, text=True, env=ENVIRONMENT)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr

"""A rough scene as a file, and a run of it by the command line in this process."""

from bem import scene_commands as command_line

SCENE = """
title = "wave"
[solid]
youngs_modulus = 1.0e6
poisson_ratio = 0.5
[profile]
kind = "self_affine"
period = 0.01
hurst = 0.7
rms_height = 50e-6
harmonics = {harmonics}
[adhesion]
work_of_adhesion = 0.03
[loading]
control = "separation"
targets = [{targets}]
[output]
shapes = [50e-6]
"""


def written_scene(folder, targets="60e-6, 50e-6, 40e-6", harmonics=20, name="scene.toml"):
    path = folder / name
    path.write_text(SCENE.format(targets=targets, harmonics=harmonics))
    return path


def run(scene, out, *options):
    return command_line.main(["run", str(scene), "--out", str(out), *options])

"""The scenes of the repository still look the way they did.

References hold more samples and another seed than the renders that are compared with them. Blocks of 6 × 6 pixels must
agree within 6 standard errors (48 blocks and three channels a scene, errors estimated from 16 rounds), the whole image
within 4. After a change that is meant: `tests/images/update.py`, and look at the images.
"""

import os
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from compare import CASES, load, reference, render, z_scores


@pytest.fixture(autouse=True)
def binary() -> None:
    if "AJAR_BIN" not in os.environ:
        pytest.skip("AJAR_BIN does not name an ajar program")


@pytest.mark.parametrize(("scene", "integrator"), CASES)
def test_scene_agrees_with_its_reference(scene: str, integrator: str, tmp_path: Path) -> None:
    target = tmp_path / "new.exr"
    render(scene, integrator, target, rounds=16, seed=1)
    worst_block, total = z_scores(target, reference(scene))
    print(f"{scene} by {integrator}: largest block z {worst_block:.2f}, image z {total:.2f}")
    assert worst_block < 6
    assert total < 4


def test_the_comparison_sees_a_missing_twentieth_of_the_light(tmp_path: Path) -> None:
    target = tmp_path / "dim.exr"
    render("cornell", "path", target, rounds=16, seed=2)
    before = z_scores(target, reference("cornell"))[1]
    mean, variance = load(target)
    spec = oiio.ImageSpec(mean.shape[1], mean.shape[0], 6, oiio.FLOAT)
    spec.channelnames = ("R", "G", "B", "variance.R", "variance.G", "variance.B")
    image = oiio.ImageBuf(spec)
    image.set_pixels(spec.roi, np.concatenate([mean * 0.95, variance], axis=2).astype(np.float32))
    image.write(str(target))
    after = z_scores(target, reference("cornell"))[1]
    assert before < 4 < after

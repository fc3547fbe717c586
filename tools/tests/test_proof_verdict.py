"""tools/proof says by its exit code what it found: alarms that chance does not explain, mutants that survive."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import mutants
import pytest
import twins

PROOF = Path(__file__).parents[1] / "proof"


def test_false_alarms_are_held_against_a_binomial_distribution() -> None:
    # Of 480 at 0.001, more than 3 have a probability of 1.7e-3, more than 4 of 1.6e-4.
    assert twins.quantile(480, 0.001) == 4
    assert twins.quantile(480, 0.05) == 40
    assert twins.most(12, 40, 0.001, in_pairs=False) == 4
    assert twins.most(12, 40, 0.001, in_pairs=True) == 39 * twins.quantile(240, 0.001)
    assert twins.excess([4, 117, 40, 1000], [4, 117, 40, 1000]) == []
    assert twins.excess([5, 0, 0, 0], [4, 117, 40, 1000]) == ["5 false alarms, chance explains 4"]


def test_mutants_that_noise_does_not_hide_must_not_survive() -> None:
    assert mutants.survivors("path", {"empty": 1.0, "energy +2 %": 0.7}) == []
    assert mutants.survivors("path", {"empty": 0.9}) == ["path: 10% of the mutants empty survive"]


def test_the_exit_code_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    spec = spec_from_file_location("proof", PROOF / "__main__.py")
    assert spec
    assert spec.loader
    proof = module_from_spec(spec)
    spec.loader.exec_module(proof)
    assert proof.exit_code([]) == 0
    assert proof.exit_code(["path: 10% of the mutants empty survive"]) == 1
    assert "empty survive" in capsys.readouterr().err

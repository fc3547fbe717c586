"""The JSON Schema of scene files takes what the program takes, and refuses what it refuses."""

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).parents[2]
SCHEMA = json.loads((ROOT / "src/scene/file/schema.json").read_text())
SCENES = sorted(ROOT.glob("scenes/**/*.toml")) + sorted(ROOT.glob("tests/**/scene.toml"))


def errors(text: str) -> list[str]:
    validator = jsonschema.Draft202012Validator(SCHEMA)
    return [error.message for error in validator.iter_errors(tomllib.loads(text))]


def test_it_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: str(path.relative_to(ROOT)))
def test_scenes_fit(scene: Path) -> None:
    assert errors(scene.read_text()) == []


def test_the_examples_of_the_reference_fit() -> None:
    examples = (ROOT / "docs/scene-file.md").read_text().split("```toml\n")[1:]
    assert len(examples) >= 2
    for example in examples:
        assert errors(example.split("```")[0]) == []


@pytest.mark.parametrize(
    "text",
    [
        "[rendr]",
        "[render]\nspp = 0",
        "[render]\nsize = [10]",
        "[[camera]]\nyfov = 180",
        '[[light]]\ntype = "lamp"',
        "[material.a]\nroughness = 2",
        "[material.a]\nroughness_texture = { wrap = 'clamp' }",
        "[node.a]\nscale = 0",
    ],
)
def test_mistakes_are_found(text: str) -> None:
    assert errors(text) != []

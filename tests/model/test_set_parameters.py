"""Values that a study sets: the model reads as if its file had been written with them."""

import pytest
from builders import DRIVEN_MASS

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.write import set_parameters, text_of


def test_values_stand_in_place_of_the_old_ones() -> None:
    model = parse_model(DRIVEN_MASS, "model.toml")
    changed = set_parameters(model, {"m": 2.5, "k": 30.0})
    by_path = {item.path: item for item in changed.all_parameters()}
    assert (by_path["m"].value, by_path["k"].value, by_path["k"].sd) == (2.5, 30.0, 0.5)
    text = DRIVEN_MASS.replace("m = { value = 1.0,", "m = { value = 2.5,")
    assert text_of(changed) == text.replace("value = 25.0", "value = 30.0")
    assert all(item.was is None for item in changed.all_parameters())
    assert set_parameters(model, {}) is model


def test_all_unknown_names_are_refused_at_once() -> None:
    model = parse_model(DRIVEN_MASS, "model.toml")
    with pytest.raises(InputError) as caught:
        set_parameters(model, {"mm": 1.0, "laser.gain": 2.0, "d": 1.0, "c": 1.0})
    said = [str(one) for one in caught.value.problems]
    assert len(said) == 3
    assert "there is no parameter 'mm'; did you mean 'm'?" in said[0]
    assert "'laser.gain' has no value in the file that another could replace" in said[1]

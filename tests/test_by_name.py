"""Tuples that take a name: the item it means, what is said where it means none or several."""

import pickle
from copy import deepcopy
from dataclasses import replace

import pytest
from builders import DRIVEN_MASS
from fakes import friction

from symhyb.by_name import ByName
from symhyb.errors import UnknownNameError
from symhyb.model.read import parse_model

MODEL = parse_model(DRIVEN_MASS)


def test_parameters_are_found_by_name_and_by_number() -> None:
    assert MODEL.parameters["k"].value == 25.0
    assert MODEL.parameters["k"] is MODEL.parameters[1]
    assert MODEL.elements["damper"].kind == "damper"
    assert MODEL.sensors["laser"].unit.text == "m"
    assert MODEL.parameters.names() == ("m", "k", "d")


def test_a_tuple_stays_a_tuple() -> None:
    plain = tuple(MODEL.parameters)
    assert MODEL.parameters == plain
    assert hash(MODEL.parameters) == hash(plain)
    assert repr(MODEL.parameters) == repr(plain)
    assert MODEL.parameters[1:] == plain[1:]
    assert [one.name for one in MODEL.parameters] == ["m", "k", "d"]
    assert replace(MODEL, parameters=plain[:1]).parameters["m"] is plain[0]
    assert parse_model(DRIVEN_MASS) == MODEL


def test_what_is_named_is_in_it() -> None:
    assert "k" in MODEL.parameters
    assert MODEL.parameters[0] in MODEL.parameters
    assert "stiffness" not in MODEL.parameters


def test_an_unknown_name_is_told_with_the_nearest_and_all() -> None:
    with pytest.raises(KeyError) as caught:
        MODEL.elements["dampfer"]
    assert str(caught.value) == (
        "there is no 'dampfer'; did you mean 'damper'?; there are: spring, damper, push"
    )
    with pytest.raises(UnknownNameError, match="there is no 'a': there is nothing here"):
        MODEL.points["a"]


def test_causes_are_found_by_kind_and_by_element() -> None:
    found = friction(0.5).found
    assert found["friction"].coulomb.value == 0.5
    assert found["found_friction"] is found["friction"] is found[0]
    assert found["friction"].F_c is found["friction"].coulomb
    assert found["friction"].estimates["coulomb"].sd == 0.006
    with pytest.raises(KeyError, match=r"there are: found_friction \(friction\)"):
        found["drag"]


def test_a_kind_of_two_causes_must_be_asked_by_element() -> None:
    (one,) = friction(0.5).found
    other = replace(one, element=replace(one.element, name="found_friction_2"))
    both = replace(friction(), found=(one, other)).found
    assert both["found_friction_2"] is other
    with pytest.raises(KeyError, match="ask for one of 'found_friction', 'found_friction_2'"):
        both["friction"]


def test_an_element_of_the_name_of_another_kind_goes_first() -> None:
    (one,) = friction(0.5).found
    other = replace(one, element=replace(one.element, name="friction", kind="drag"))
    assert replace(friction(), found=(one, other)).found["friction"] is other


def test_an_unknown_estimate_is_an_attribute_error_with_what_there_is() -> None:
    (one,) = friction(0.5).found
    with pytest.raises(AttributeError, match=r"found_friction: there is no 'colomb'; did you mean"):
        _ = one.colomb
    assert not hasattr(one, "stiffness")
    assert "coulomb" in dir(one)


def test_found_values_travel() -> None:
    """Looking up estimates as attributes must not stand in the way of making a copy."""
    answer = friction(0.5)
    for copied in (deepcopy(answer), pickle.loads(pickle.dumps(answer))):
        assert copied == answer
        assert type(copied.found) is ByName
        assert copied.found["friction"].coulomb.value == 0.5

"""Displacements and inertias: against SciPy's rotations, point masses, and known bodies."""

from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from symhyb.imports.rigid import (
    DENSITY,
    Pose,
    about,
    about_point,
    about_vector,
    ball,
    from_pseudo_inertia,
    from_rpy,
    here,
    is_of_a_body,
    joined,
    moved,
    nearest_of_a_body,
    pseudo_inertia,
    quaternion_of,
    right_angles,
    to_rpy,
)
from symhyb.imports.robot import Inertial

DRAWN = np.random.default_rng(0).uniform(-3, 3, (8, 3))


@pytest.mark.parametrize("rpy", DRAWN)
def test_roll_pitch_and_yaw_are_about_fixed_axes(rpy: np.ndarray) -> None:
    turned = from_rpy(list(rpy))
    assert np.allclose(turned, Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-15)
    assert np.allclose(from_rpy(to_rpy(turned)), turned, atol=1e-14)
    w, x, y, z = quaternion_of(turned)
    assert np.allclose(Rotation.from_quat([x, y, z, w]).as_matrix(), turned, atol=1e-14)
    assert w >= 0


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
def test_at_gimbal_lock_the_roll_is_zero(pitch: float) -> None:
    turned = from_rpy((0.3, pitch, 0.5))
    assert to_rpy(turned)[0] == 0.0
    assert np.allclose(from_rpy(to_rpy(turned)), turned, atol=1e-14)


def test_right_angles_are_exact() -> None:
    assert [right_angles(angle) for angle in (0.0, 1.57079632679, -pi, 7.853981634)] == [
        0,
        1,
        -2,
        5,
    ]
    assert right_angles(1.5708) is None  # four digits say less
    assert about(2, 1.57079632679).tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]


def test_a_turn_about_any_vector() -> None:
    axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    turned = about_vector(list(axis), 0.7)
    assert np.allclose(turned, Rotation.from_rotvec(0.7 * axis).as_matrix(), atol=1e-15)
    assert np.allclose(quaternion_of(about_vector((1, 0, 0), pi)), [0, 1, 0, 0], atol=1e-15)


def points(mass: np.ndarray, at: np.ndarray) -> Inertial:
    """Rigid points of mass, as one body, by the definition of the tensor."""
    centre = mass @ at / mass.sum()
    arms = at - centre
    tensor = sum(
        m * ((r @ r) * np.eye(3) - np.outer(r, r)) for m, r in zip(mass, arms, strict=True)
    )
    return Inertial(float(mass.sum()), centre, np.asarray(tensor))


def test_bodies_that_are_welded_are_one_body() -> None:
    rng = np.random.default_rng(1)
    mass, at = rng.uniform(0.1, 2, 10), rng.uniform(-1, 1, (10, 3))
    whole, parts = points(mass, at), [points(mass[:4], at[:4]), points(mass[4:], at[4:])]
    found = joined(parts)
    assert found.mass == pytest.approx(whole.mass)
    assert np.allclose(found.centre, whole.centre, atol=1e-14)
    assert np.allclose(found.tensor, whole.tensor, atol=1e-14)
    pose = Pose(from_rpy((0.3, -0.2, 0.9)), np.array([0.5, 0.1, -0.4]))
    carried = points(mass, at @ pose.turned.T + pose.at)
    assert np.allclose(moved(whole, pose).centre, carried.centre, atol=1e-14)
    assert np.allclose(moved(whole, pose).tensor, carried.tensor, atol=1e-13)
    assert np.allclose(here().then(pose).turned, pose.turned)


def test_pseudo_inertias_are_sums_over_points_in_any_frame() -> None:
    rng = np.random.default_rng(2)
    mass, at = rng.uniform(0.1, 2, 10), rng.uniform(-1, 1, (10, 3))
    arms = np.column_stack([at, np.ones(10)])
    whole = points(mass, at)
    assert np.allclose(pseudo_inertia(whole), arms.T @ (mass[:, None] * arms), atol=1e-14)
    pose = Pose(from_rpy((0.3, -0.2, 0.9)), np.array([0.5, 0.1, -0.4]))
    turned = pseudo_inertia(moved(whole, pose))
    assert np.allclose(turned, pose.matrix @ pseudo_inertia(whole) @ pose.matrix.T, atol=1e-13)
    back = from_pseudo_inertia(pseudo_inertia(whole))
    assert back.mass == pytest.approx(whole.mass)
    assert np.allclose(back.centre, whole.centre, atol=1e-15)
    assert np.allclose(back.tensor, whole.tensor, atol=1e-13)


def test_of_a_point_no_inertia_is_left_by_rounding() -> None:
    point = Inertial(0.37, np.array([0.1, 0.7, -0.3]), np.zeros((3, 3)))
    assert not from_pseudo_inertia(pseudo_inertia(point)).tensor.any()
    rotor = from_pseudo_inertia(pseudo_inertia(Inertial(0.0, np.zeros(3), np.eye(3))))
    assert rotor.mass == 0
    assert np.array_equal(rotor.tensor, np.eye(3))


def test_without_mass_inertias_add() -> None:
    rotor = Inertial(0.0, np.ones(3), np.eye(3))
    assert np.allclose(joined([rotor, rotor]).tensor, 2 * np.eye(3))
    assert np.allclose(about_point(rotor, np.zeros(3)), np.eye(3))


@pytest.mark.parametrize(
    ("moments", "possible"),
    [
        ((1, 1, 1), True),
        ((1, 1, 2), True),  # a plate
        ((0, 1, 1), True),  # a rod
        ((0, 0, 0), True),  # a point
        ((1, 1, 2.001), False),
        ((-1, 1, 1), False),
        ((0, 0, 1), False),
        ((-1, -1, -1), False),
    ],
)
def test_which_moments_a_body_can_have(moments: tuple[float, ...], possible: bool) -> None:
    turned = from_rpy((0.3, 0.4, 0.5))
    tensor = turned @ np.diag(moments) @ turned.T
    assert is_of_a_body(tensor) is possible
    nearest = nearest_of_a_body(tensor)
    assert is_of_a_body(nearest)
    if possible:
        assert np.allclose(nearest, tensor, atol=1e-15)


def test_the_nearest_body_has_the_second_moments_that_are_not_negative() -> None:
    """xx = (J_yy + J_zz − J_xx)/2: here 1.5, 1.5 and −0.5, of which the last becomes 0."""
    assert np.allclose(nearest_of_a_body(np.diag([1, 1, 3])), np.diag([1.5, 1.5, 3]))


def test_a_body_may_be_no_thinner_than_told() -> None:
    plate = nearest_of_a_body(np.diag([1.0, 1.0, 2.0]), 0.1)
    assert np.allclose(plate, np.diag([1.1, 1.1, 2.0]))


def test_a_ball_of_aluminium() -> None:
    mass = DENSITY * 4 / 3 * pi * 0.1**3
    assert ball(mass) == pytest.approx(0.4 * mass * 0.01)

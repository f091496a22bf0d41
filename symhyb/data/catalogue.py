"""The known public recordings, as plain values.

Addresses name a commit, so that they point to the same bytes for good.
"""

from dataclasses import dataclass
from urllib.parse import quote

from symhyb.errors import did_you_mean


@dataclass(frozen=True, slots=True)
class DataFile:
    """One file: ``size`` in bytes, ``sha256`` of its bytes, ``address`` to fetch it from."""

    name: str
    size: int
    sha256: str
    address: str


@dataclass(frozen=True, slots=True)
class Dataset:
    """A public recording: ``folder`` is its name in ``SYMHYB_DATA``, ``about`` what it holds."""

    name: str
    folder: str
    title: str
    files: tuple[DataFile, ...]
    licence: str
    citation: str
    about: str


def _github(repository: str, commit: str, path: str, size: int, sha256: str) -> DataFile:
    address = f"https://raw.githubusercontent.com/{repository}/{commit}/{quote(path)}"
    return DataFile(path.rpartition("/")[2], size, sha256, address)


_EMPS = "forgi86/sysid-neural-continuous", "93afc131780fb1d5477472935a18ac8405683890"
_SILVERBOX = "forgi86/pytorch-ident", "e116bdf174281964e149e30f03c42c558a0a8559"
_ROLL = (
    "martinlarsalbert/Prediction-of-roll-motion-using-fully-nonlinear-potential-flow-and-Ikedas-"
    "method"
)
_ROLL_REST = _ROLL, "162deeae9c1807ba4e31aa4016e940450e01ac1f"
_ROLL_SPEED = _ROLL, "84775dda2df71b8dcdf54c0c21ea25b38a18982f"
_ARM = "dynamicslab/MultiArm-Pendulum"
_ARM_ONE = _ARM, "78ed9353702f1f9e92c74d3bb671a7804fb41fb0"
_ARM_TWO = _ARM, "f307b41f16fe48b283f7589694c144d87912ed58"
_BALLS = "briandesilva/discovery-of-physics-from-data", "480510008d15d30fe41b4dcd18bb4d01e6549c8e"
_DAMPER = (
    "ARTS-Laboratory/Dataset-Friction-Damper-with-Backlash",
    "19a2e2e7276cb9e5821945cd14d98fba331d9fa0",
)

DATASETS: tuple[Dataset, ...] = (
    Dataset(
        name="emps",
        folder="emps",
        title="Electro-mechanical positioning system: a linear ball-screw drive",
        files=(
            _github(
                *_EMPS,
                "examples/EMPS/data/DATA_EMPS.mat",
                626039,
                "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
            ),
            _github(
                *_EMPS,
                "examples/EMPS/data/DATA_EMPS_PULSES.mat",
                630990,
                "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704",
            ),
        ),
        licence="Apache-2.0 of the repository; the licence of the data itself is not stated",
        citation=(
            "A. Janot, M. Gautier, M. Brunot: Data set and reference models of EMPS. Workshop on"
            " Nonlinear System Identification Benchmarks, Eindhoven, 2019"
        ),
        about=(
            "t [s], qm measured position [m], force gtau*vir [N], qg reference position; 1 kHz,"
            " two runs of 24.8 s in closed loop; vir of the pulses run already holds the pulses"
        ),
    ),
    Dataset(
        name="silverbox",
        folder="silverbox",
        title="Silverbox: an electronic Duffing oscillator",
        files=(
            _github(
                *_SILVERBOX,
                "examples/statespace/silverbox/SilverboxFiles/SNLS80mV.csv",
                2649634,
                "ae62d5a91230c10f76e6dd02c8a4fac3c9d4d8a95fbf50e87cb0c4885003e0f1",
            ),
        ),
        licence="MIT of the repository; the licence of the data itself is not stated",
        citation=(
            "T. Wigren, J. Schoukens: Three free data sets for development and benchmarking in"
            " nonlinear system identification. European Control Conference, 2013"
        ),
        about="V1 input [V], V2 output [V], no time: t = index/610.3515625",
    ),
    Dataset(
        name="kvlcc2_rolldecay",
        folder="kvlcc2_rolldecay",
        title="Roll decay of a tanker model (KVLCC2) in a towing tank",
        files=(
            _github(
                *_ROLL_REST,
                "data/processed/model_test_21337.csv",
                1270451,
                "ae63c90498fcc502d28f4408721d5c5490437b3d7ed9767d78a393ea9ecd2168",
            ),
            _github(
                *_ROLL_REST,
                "data/processed/model_test_21338.csv",
                2771595,
                "ba59c8527f9fdd9f5031a3bb45345fe9d419def59a163a47c9c3ec7eea8bbc80",
            ),
            _github(
                *_ROLL_SPEED,
                "data/processed/roll decay KVLCC2/model_test_21340.csv",
                1250987,
                "031dddff3b7c5d49c612a17076e83e6adcdcae6fadb8b2d4a7d93c518132bdd1",
            ),
        ),
        licence="MIT of the repository; the licence of the data itself is not stated",
        citation=(
            "M. Alexandersson et al.: Prediction of roll motion using fully nonlinear potential"
            " flow and Ikeda's method. ISOPE, 2021"
        ),
        about=(
            "time [s], phi roll [rad] and five other motions; 100 Hz; 21337 and 21338 at 0 kn,"
            " 21340 at speed; the model rolls freely at 25.5-91, 9.3-89 and 24.4-69 s"
        ),
    ),
    Dataset(
        name="pendulum",
        folder="multiarm_pendulum",
        title="Single and double pendulum on a locked cart",
        files=(
            _github(
                *_ARM_ONE,
                "ParameterEstimation/SinglePendulum/SinglePendulumDataForParameterEstimation.mat",
                998011,
                "f3b8cdda4a6e86405ec37ff32b98be76fd37806a609cba7870628c1e40377a98",
            ),
            _github(
                *_ARM_ONE,
                "ParameterEstimation/SinglePendulum/EstimatedParameters_SinglePendulum.mat",
                235,
                "64108f0f69a202f8893a376bd87b69cd54ed13664aed33db085766639a5b0962",
            ),
            _github(
                *_ARM_TWO,
                "ParameterEstimation/DoublePendulum/DoublePendulumDataForParameterEstimation.mat",
                2664305,
                "4bf9e4006aa83b2b003295ac1b1946717eec87d76873834d6248683aca419902",
            ),
            _github(
                *_ARM_TWO,
                "ParameterEstimation/DoublePendulum/EstimatedParameters_DoublePendulum.mat",
                278,
                "786fb808d6ecfd770cf89d770778cb473a66223a5e63790bbc94277f2e5b3517",
            ),
        ),
        licence="MIT",
        citation=(
            "K. Kaheman et al.: The experimental multi-arm pendulum on a cart: a benchmark system"
            " for chaos, learning, and control, 2022"
        ),
        about=(
            "cell arrays of angles [rad] and rates [rad/s], 1 ms, pi = hanging: the third one is"
            " FILE#3 with t=Time_id and the angle Y_id.1"
        ),
    ),
    Dataset(
        name="balldrops",
        folder="balldrops",
        title="Eleven kinds of balls dropped from a bridge of 45 m",
        files=(
            _github(
                *_BALLS,
                "Data/Ball_drops_data.xls",
                58550,
                "942b2d68abfff3828ca323de491435d4ec27c3a22e62cee0cbdf52c2e8d1c0ed",
            ),
            _github(
                *_BALLS,
                "Data/balls.txt",
                443,
                "7cc282a6559ef636ce30cad53aae5bf825ce6200a94dd54f668af9797c584585",
            ),
        ),
        licence="MIT",
        citation=(
            "B. de Silva et al.: Discovery of physics from data: universal laws and discrepancies."
            " Frontiers in Artificial Intelligence 3:25, 2020"
        ),
        about=(
            "a sheet a ball, two drops each: Time (s) at 15 Hz, Height (m), differenced velocity;"
            " the second drop of the golf ball is 'FILE#Golf Ball#2'; weight [oz] and"
            " circumference [cm] in balls.txt"
        ),
    ),
    Dataset(
        name="brfd",
        folder="brfd_backlash_damper",
        title="Banded rotary friction damper with backlash on a test rig",
        files=(
            _github(
                *_DAMPER,
                "data/dataset-2/characterization datasets/0.5Hz30lbtension1amplitude.json",
                1665902,
                "3d58d0f71296a6221974c14454352fa29a27d536295fd5cb05e6d946a7cf30db",
            ),
            _github(
                *_DAMPER,
                "data/dataset-2/characterization datasets/1Hz30lbtension1.5amplitude.json",
                826508,
                "1a894d5857486ee56f363343c3216d2fb300c2fc8777439cca8ee2d02a7dd35c",
            ),
        ),
        licence="CC BY-SA 4.0",
        citation=(
            "D. Coble, P. Huggins, L. Cao, J. Ricles, A. Downey:"
            " Dataset-Friction-Damper-with-Backlash. GitHub, 2022"
        ),
        about=(
            "data.1 t [s], data.2 displacement [in], data.3 friction force [kip], data.4 velocity"
            " [in/s], data.5 and data.6 actuator forces [lbf]; 1024 Hz; the motion is imposed"
        ),
    ),
)


def named(name: str) -> Dataset | None:
    """Return the recording of that name, or in the folder of that name; None if there is none."""
    for known in DATASETS:
        if name in (known.name, known.folder):
            return known
    return None


def unknown(name: str) -> str:
    """Say that no recording is known by a name, with the nearest that is."""
    names = [known.name for known in DATASETS]
    near = did_you_mean(name, [*names, *(known.folder for known in DATASETS)])
    hint = near if "did you mean" in near else did_you_mean(name, names)
    return f"no recording is known by the name '{name}'{hint}"

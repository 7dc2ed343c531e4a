"""What one asks of a test plan: tests, sensors, what is unknown, what tests cost, and how well one wants to know."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PlannedTests:
    """The tests that could be made: every combination of the values.

    Args:
        durations: Lengths of the records, s.
        sampling_rate: Hz.
        speeds: Of the pinion, rad/s; that of the model where empty.
        torques: On the pinion, N m; that of the model where empty.
        amplitudes: Displacements from which an oscillator is let go, m; that of the model where empty.
        settle: Seconds that the rig runs before the record begins. None: a gear pair until its transients have
            faded, an oscillator not at all. 0: the record begins as the model begins.
    """

    durations: tuple[float, ...]
    sampling_rate: float
    speeds: tuple[float, ...] = ()
    torques: tuple[float, ...] = ()
    amplitudes: tuple[float, ...] = ()
    settle: float | None = None


@dataclass(frozen=True)
class PlannedSensor:
    """A sensor with white noise, behind the sensor effects of the model.

    Args:
        name: Its name.
        noise: Standard deviation in the SI unit of its channel; or
        snr_db: Level below the signal about its mean, over the shortest planned record of each setting.
        channel: What it sees: `response`, `transmission_error`, `pinion_speed`, `gear_speed`, `pinion_acceleration` or
            `gear_acceleration` (angular); of an oscillator `displacement`, `velocity` or `acceleration`. Its name
            where absent.
        offset: Whether its zero is unknown in every record.
        cost: Of having it at all.
    """

    name: str
    noise: float | None = None
    snr_db: float | None = None
    channel: str = ""
    offset: bool = False
    cost: float = 0.0

    @property
    def sees(self) -> str:
        """The channel."""
        return self.channel or self.name


@dataclass(frozen=True)
class Unknown:
    """A parameter of the model that is unknown beside the damping.

    Args:
        name: By flat name.
        deviation: Standard deviation of what is known of it beforehand, SI; or
        percent: the same in % of its value. Nothing is known of it where neither is given.
        each: Whether it is another one in every test, as the error of a torque that is set anew.
    """

    name: str
    deviation: float | None = None
    percent: float | None = None
    each: bool = False


@dataclass(frozen=True)
class PlanCosts:
    """What tests cost, in any one unit.

    Args:
        per_test: Each record.
        per_second: Of record.
        per_speed: Each speed that occurs in a set.
        per_torque: Each torque that is set at each speed.
    """

    per_test: float = 1.0
    per_second: float = 0.0
    per_speed: float = 0.0
    per_torque: float = 0.0


@dataclass(frozen=True)
class PlanGoal:
    """How well the damping shall be known, and with how many tests at most.

    Args:
        percent: Half of the 95 % interval of the damping ratio, in % of it.
        joint: Whether the exponent of the law is unknown too.
        exponent: Half of the 95 % interval of that exponent; None: as it comes.
        most_tests: In a set.
        repeats: How often one test may be made.
        costs: What tests cost.
        law: Name of the damping law that is meant; the one that the model has where None.
    """

    percent: float = 10.0
    joint: bool = False
    exponent: float | None = None
    most_tests: int = 4
    repeats: int = 1
    costs: PlanCosts = PlanCosts()
    law: str | None = None

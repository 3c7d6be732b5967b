"""FMUs, validated and run by FMPy, compared with plans of the C functions."""

import zipfile

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import (
    FMU3Slave,
    fmi3IntermediateUpdateCallback,
    fmi3LogMessageCallback,
    fmi3ValueReference,
)
from fmpy.validation import validate_fmu
from pack import pack

STEP_S = 0.001
TOLERANCE = 1e-12
NAMES = {
    "q": [f"q[{j}]" for j in range(1, 8)],
    "dq": [f"dq[{j}]" for j in range(1, 8)],
    "tcp_m": [f"tcp[{i}]" for i in range(1, 4)],
    "tcp_xyzw": [f"orientation[{i}]" for i in range(1, 5)],
}


def simulate(fmu, inputs, stop_s):
    """Simulates an FMU; inputs are rows of time, start and override."""
    # The last row is repeated at the end, as FMPy does not accept a single row.
    inputs = [*inputs, (stop_s + 1.0, *inputs[-1][1:])]
    signals = np.array(inputs, dtype=[("time", float), ("start", bool), ("override", float)])
    return simulate_fmu(str(fmu), stop_time=stop_s, output_interval=STEP_S, input=signals)


def columns(result, key):
    return np.column_stack([result[name] for name in NAMES[key]])


def difference(library, plan, result, program_s, rate):
    """Differences between outputs and plan, for the program times `program_s` and the program rates
    `rate`.
    """
    states = [library.at(plan, t_s) for t_s in program_s]
    largest = 0.0
    for key in NAMES:
        planned = np.array([getattr(state, key) for state in states])
        if key == "dq":
            planned *= np.asarray(rate)[:, None]
        largest = max(largest, np.abs(columns(result, key) - planned).max())
    running = (program_s > 0) & ~result["done"]
    motions = np.where(running, [state.motion for state in states], 0)
    assert (result["motion"] == motions).all(), "motions differ"
    return largest


def check(library, binary, program, folder):
    fmu = folder / f"{program.stem}.fmu"
    pack(fmu, program, binary)
    first = fmu.read_bytes()
    pack(fmu, program, binary)
    assert fmu.read_bytes() == first, "the same program gives another FMU"
    problems = validate_fmu(str(fmu))
    assert problems == [], problems
    with library.plan(program) as plan:
        cycle_s = library.figures(plan)["cycle_time_s"]
        results = {
            "begun at 0": at_full_speed(library, plan, fmu, cycle_s, 0.0),
            "begun at 0.3 s": at_full_speed(library, plan, fmu, cycle_s, 0.3),
            "override 0.5": at_half_speed(library, plan, fmu, cycle_s),
            "override changed, and 0": overrides(library, plan, fmu, cycle_s),
            "begun again": begun_again(library, plan, fmu, cycle_s),
            "two at once, reset, state": by_hand(library, plan, fmu, folder, cycle_s),
        }
    largest = max(results.values())
    assert largest <= TOLERANCE, results
    megabytes = fmu.stat().st_size / 1e6
    print(
        f"{fmu.name}: {megabytes:.1f} MB, FMPy has found no problem; outputs differ by at most "
        f"{largest:.1e}"
    )


def at_full_speed(library, plan, fmu, cycle_s, start_s):
    inputs = [(0.0, False, 1.0), (start_s, True, 1.0)] if start_s else [(0.0, True, 1.0)]
    result = simulate(fmu, inputs, start_s + cycle_s + 0.2)
    program_s = np.clip(result["time"] - start_s, 0.0, cycle_s)
    assert (result["done"] == (result["time"] - start_s >= cycle_s - 1e-9)).all()
    assert result["done"][-1] and result["motion"][-1] == 0 and result["motion"][0] == 0
    return difference(library, plan, result, program_s, np.ones(len(result)))


def at_half_speed(library, plan, fmu, cycle_s):
    result = simulate(fmu, [(0.0, True, 0.5)], 2 * cycle_s + 0.2)
    done_s = result["time"][np.argmax(result["done"])]
    assert 0.0 <= done_s - 2 * cycle_s < STEP_S + 1e-9, (
        f"done at {done_s} s, the cycle time is {cycle_s} s"
    )
    return difference(
        library, plan, result, np.clip(0.5 * result["time"], 0, cycle_s), np.full(len(result), 0.5)
    )


def overrides(library, plan, fmu, cycle_s):
    """Override 1 for 0.4 s, 0 for 0.2 s, then 0.3: the program time has a corner at each change."""
    end_s = 0.6 + (cycle_s - 0.4) / 0.3
    result = simulate(fmu, [(0.0, True, 1.0), (0.4, True, 0.0), (0.6, True, 0.3)], end_s + 0.1)
    t = result["time"]
    program_s = np.where(t <= 0.4, t, np.where(t <= 0.6, 0.4, 0.4 + 0.3 * (t - 0.6)))
    # Outputs belong to the step that has ended: at a change, they still have the previous speed.
    rate = np.where(t <= 0.4 + 1e-9, 1.0, np.where(t <= 0.6 + 1e-9, 0.0, 0.3))
    return difference(library, plan, result, np.clip(program_s, 0, cycle_s), rate)


def begun_again(library, plan, fmu, cycle_s):
    """A rising start input is ignored while the program runs, and restarts it after its end."""
    again_s = round(cycle_s + 0.5, 3)
    inputs = [
        (0.0, True, 1.0),
        (0.2, False, 1.0),
        (0.3, True, 1.0),
        (cycle_s + 0.1, False, 1.0),
        (again_s, True, 1.0),
    ]
    result = simulate(fmu, inputs, again_s + cycle_s + 0.1)
    t = result["time"]
    # At the instant of the restart, outputs belong to the step before.
    second = t > again_s + 1e-9
    assert result["done"][~second][-1] and not result["done"][second][0] and result["done"][-1]
    program_s = np.where(second, t - again_s, t)
    return difference(library, plan, result, np.clip(program_s, 0, cycle_s), np.ones(len(result)))


class ByHand:
    """An FMU instance with single calls."""

    def __init__(self, fmu, folder, begins=True):
        self.folder = extract(str(fmu), unzipdir=str(folder))
        self.description = read_model_description(self.folder)
        self.reference = {
            variable.name: variable.valueReference for variable in self.description.modelVariables
        }
        self.messages = []
        self.slave = FMU3Slave(
            guid=self.description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        if begins:
            self.slave.instantiate(logMessage=self.callback())
            self.begin()

    def callback(self):
        def log(_environment, status, _category, message):
            self.messages.append((status, message.decode()))

        self.kept = fmi3LogMessageCallback(log)
        return self.kept

    def begin(self):
        self.time_s = 0.0
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def start(self, value=True):
        self.slave.setBoolean([self.reference["start"]], [value])

    def step(self, step_s=0.01):
        self.slave.doStep(currentCommunicationPoint=self.time_s, communicationStepSize=step_s)
        self.time_s += step_s

    def q(self):
        return np.array(self.slave.getFloat64([self.reference[name] for name in NAMES["q"]]))

    def refused(self, says, status, work):
        try:
            work()
        except FMICallException as error:
            assert error.status == status and self.messages, f"{error}, {self.messages}"
            found, message = self.messages.pop()
            assert found == status and says in message, message
            return
        raise AssertionError(f"nothing is refused where {says!r} should be")

    def close(self):
        self.slave.freeInstance()


def by_hand(library, plan, fmu, folder, cycle_s):
    # One instance of each of two copies of the FMU, in the same process, started at different
    # times.
    one, other = ByHand(fmu, folder / "one"), ByHand(fmu, folder / "other")
    largest = 0.0

    def compare(instance, program_s):
        nonlocal largest
        planned = np.array(library.at(plan, min(max(program_s, 0.0), cycle_s)).q)
        largest = max(largest, np.abs(instance.q() - planned).max())

    one.start()
    for i in range(60):
        if i == 20:
            other.start()
            began_s = other.time_s
        one.step()
        other.step()
        compare(one, one.time_s)
        compare(other, other.time_s - began_s if i >= 20 else 0.0)
    # Restores a state, and repeats the same steps.
    state, time_s = one.slave.getFMUState(), one.time_s
    for _ in range(2):
        one.slave.setFMUState(state)
        one.time_s = time_s
        for _ in range(10):
            one.step()
            compare(one, one.time_s)
    one.slave.freeFMUState(state)
    one.slave.reset()
    one.begin()
    compare(one, 0.0)
    one.start()
    one.step()
    compare(one, one.time_s)
    refusals(one)
    one.close()
    other.step()
    compare(other, other.time_s - began_s)
    other.close()
    return largest


def refusals(one):
    slave, reference = one.slave, one.reference
    discard, error = 2, 3
    for value in (-0.1, 1.5, float("nan"), float("inf")):
        one.refused(
            "override is",
            discard,
            lambda value=value: slave.setFloat64([reference["override"]], [value]),
        )
    q1 = reference["q[1]"]
    one.refused("q[1] is not an input", error, lambda: slave.setFloat64([q1], [0.0]))
    one.refused("q[1] is of another type", error, lambda: slave.getBoolean([q1]))
    one.refused("no variable has the value reference 99", error, lambda: slave.getFloat64([99]))
    one.refused("no variables of this type", error, lambda: slave.getInt64([q1]))
    one.refused("it must be above 0", error, lambda: one.step(0.0))
    one.refused("the simulation is at", error, lambda: slave.doStep(0.0, 0.001))
    one.refused("in the state Step", error, lambda: slave.enterInitializationMode())
    one.refused("no event mode", error, lambda: slave.enterEventMode())
    # Refused calls have not changed the state.
    one.step()


def check_two_programs(library, binary, programs, folder):
    """Different programs in one process, stepped in turns."""
    instances = []
    for program in programs:
        fmu = folder / f"{program.stem}.fmu"
        pack(fmu, program, binary)
        instances.append(ByHand(fmu, folder / f"beside-{program.stem}"))
    largest = 0.0
    for instance in instances:
        instance.start()
    for _ in range(200):
        for instance in instances:
            instance.step()
    for instance, program in zip(instances, programs):
        with library.plan(program) as plan:
            planned = np.array(library.at(plan, instance.time_s).q)
        largest = max(largest, np.abs(instance.q() - planned).max())
        instance.close()
    assert largest <= TOLERANCE, largest
    print(
        f"{len(programs)} FMUs of different programs in one process differ by at most {largest:.1e}"
    )


def check_altered(binary, program, folder):
    """FMUs with altered resources."""
    fmu = folder / "altered.fmu"
    pack(fmu, program, binary)
    with zipfile.ZipFile(fmu) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    contents["resources/options.json"] = contents["resources/options.json"].replace(b"100", b"101")
    with zipfile.ZipFile(fmu, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    altered = ByHand(fmu, folder / "altered", begins=False)
    token = altered.description.instantiationToken.encode()
    resources = f"{altered.folder}/resources/".encode()
    none = (fmi3ValueReference * 0)()
    made = altered.slave.fmi3InstantiateCoSimulation(
        b"altered",
        token,
        resources,
        *[False] * 4,
        none,
        0,
        None,
        altered.callback(),
        fmi3IntermediateUpdateCallback(),
    )
    assert made is None and "make the FMU anew" in altered.messages[0][1], altered.messages
    print("an FMU with other resources is refused")

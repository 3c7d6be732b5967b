"""Projects for targets and paths: joints, frames, tools, paths, batches."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians
from pathlib import Path

from poses import Pose, deg
from program import Program, exact_deg, placed
from station import Frame, Load, Station, Tool


def joints(folder: Path) -> Program:
    p = Program(folder, Station(), "ShelfScan")
    ready = [0, radians(25), 0, -pi / 2, 0, radians(65), 0]
    p.ptp(ready, "ptp(ready).setJointVelocityRel(FAST)", velocity_rel=0.6)
    for pan, tilt, velocity in [(-20, 20, 0.6), (0, 32.5, 0.15), (20, 45, 0.15)]:
        to = [radians(pan), radians(tilt), 0, -1.4, 0, radians(60), 0]
        p.ptp(to, "ptp(pan, tilt", velocity_rel=velocity, acceleration_rel=0.5)
    p.ptp([0.35, 0.7, 0.1, -1.2, 0, 0.9, 0], "JointPosition(corner)", jerk_rel=0.5)
    p.ptp([-0.35, 0.7, -0.1, -1.2, 0, 0.9, 0], "JointPosition(corner)", jerk_rel=0.25)
    p.ptp([*ready[:6], -radians(45)], "ptp(wound)")
    p.ptp([*ready[:6], -radians(45) - radians(45)], "ptp(wound)")
    p.ptp(ready, "gentleWrist)", velocity_rel=[0.8, 0.8, 0.8, 0.8, 0.4, 0.4, 0.25])
    p.ptp([0] * 7, "ptpHome()", velocity_rel=0.25 + 3 * 0.1)
    return p


def frames(folder: Path) -> Program:
    station = Station(
        frames={
            "Parking": Frame(Pose(412.5, -180.25, 655.0, 2.655, 0.0034, 3.1379), -0.12, 2),
            "Table": Frame(deg(480, -260, 95, 12, 0.4, -0.2)),
            "Table/Above": Frame(Pose(40.2, 60.9, 310.4, 2.3363, 0.0121, -3.1342), 0.05, 2),
            "Table/Part1": Frame(Pose(10.6, 20.1, 182.3, 2.3356, 0.0112, -3.1339), 0.0874, 2),
            "Table/Part2": Frame(Pose(95.4, 18.7, 181.9, 2.3349, 0.0127, -3.1347), 0.1105, 2),
            "Lathe": Frame(deg(160, 650, 200, 90, 0, 0)),
            "Lathe/Door": Frame(Pose(-160.0, 10.5, 260.0, 0.9979, 1.2217, -3.1301), 0.31, 2),
            "Lathe/Door/Chuck": Frame(Pose(4.0, -3.5, 95.0, 0.0213, -0.0117, 0.0058), 0.36, 2),
            "Spare": Frame(Pose(300, 300, 300)),
        }
    )
    p = Program(folder, station, "MachineTending")
    p.ptp("Parking", 'getFrame("/Parking")).setJointVelocityRel', velocity_rel=0.5)
    for part in ["Table/Part1", "Table/Part2"]:
        p.ptp("Table/Above", "ptp(aboveTable)")
        p.lin(part, "getFrame(path)", cart_velocity_mm_s=120)
        p.wait(0.3, "milliSleep(300)")
        limits = {
            "cart_velocity_mm_s": 250,
            "cart_acceleration_mm_s2": 1500,
            "cart_jerk_mm_s3": 20000,
        }
        p.lin("Table/Above", "lin(aboveTable)", **limits)
        p.ptp("Lathe/Door", "ptp(door)", velocity_rel=0.5, acceleration_rel=0.8)
        turning = {
            "orientation_velocity_deg_s": exact_deg(0.5),
            "orientation_acceleration_deg_s2": exact_deg(2),
        }
        p.lin("Lathe/Door/Chuck", "lin(chuck)", cart_velocity_mm_s=60, **turning)
        p.wait(1.25, "milliSleep(1250)")
        p.lin("Lathe/Door", "lin(door)", cart_velocity_mm_s=200, velocity_rel=0.9)
    p.ptp("Parking", 'getFrame("/Parking")));')
    return p


def computed_frames(folder: Path) -> Program:
    plate = deg(430, -90, 120, 8, 0.3, -0.5)
    corner = Pose(25.4, 31.8, 140.2, 2.4088, 0.0093, 3.1352)
    station = Station(frames={"Plate": Frame(plate), "Plate/Corner": Frame(corner, -0.21, 2)})
    kept = station.redundancy("Plate/Corner")
    p = Program(folder, station, "GridInspection")
    p.ptp("Plate/Corner", "ptp(corner).setJointVelocityRel", velocity_rel=0.4)
    for row in range(2):
        for column in range(3):
            spot = replace(corner, x=corner.x + 40.0 * column, y=corner.y + 40.0 * row)
            p.lin(placed(plate.then(spot), kept), "lin(spot)", cart_velocity_mm_s=150)
    above = replace(corner, z=corner.z + 60, a=corner.a + radians(30))
    p.lin(placed(plate.then(above)), "lin(above)")
    tilted = corner.then(deg(0, 0, -50, 0, 12, 0))
    p.ptp(placed(plate.then(tilted), kept), "ptp(tilted)", velocity_rel=0.3)
    tilted = tilted.then(Pose(0, 25, -10).then(Pose(a=0.2)))
    p.lin(placed(plate.then(tilted), kept), "lin(tilted)")
    p.lin(
        placed(plate.then(Pose(90, 70, 140, 2.7, 0.05, radians(178)))),
        "lin(middle)",
        cart_velocity_mm_s=80,
    )
    p.lin(placed(Pose(500, -120, 420, 2.85, -0.02, 3.1)), "lin(aside)")
    p.ptp("Plate/Corner", "ptp(corner));")
    return p


def tools(folder: Path) -> Program:
    gripper = Load(1.4, (0, 0, 62), (0.0031, 0.0028, 0.0012))
    probe = Load(0.35, (1.5, -2, 48), (0.0004, 0.0004, 0.0001))
    casting = Load(2.1, (0, 0, 45), (0.0042, 0.0051, 0.0037))
    station = Station(
        frames={
            "Crate": Frame(deg(400, 150, 60, -15, 0, 0)),
            "Crate/Above": Frame(Pose(110, 60, 420, 2.8118, 0.0042, 3.1385), 0.02, 2),
            "Crate/Pick": Frame(
                Pose(105.3, 62.2, 90.7, 2.8124, 0.0051, 3.1391), 0.1, 2, "DoubleGripper/Tip"
            ),
            "Scale": Frame(
                Pose(420.0, -250.0, 170.5, 2.13, -0.0073, -3.1377), -0.15, 2, "DoubleGripper/Tip"
            ),
        },
        tools={
            "DoubleGripper": Tool(
                {"Tip": Pose(0, 0, 190), "Side": Pose(60, 0, 150, 0, 0.7, 0)}, gripper
            ),
            "Probe": Tool({"Ball": Pose(0, 0, 142.5)}, probe),
            "Brush": Tool({"Bristles": Pose(0, 0, 80)}, Load(0.2)),
        },
        workpieces={"Casting": casting},
    )
    p = Program(folder, station, "GripAndWeigh", "DoubleGripper")
    p.ptp([0, 0.5, 0, -1.3, 0, 1.1, 0], "ptp(0, 0.5")
    p.ptp("Crate/Pick", "tip.move(ptp(pick)", velocity_rel=0.5)
    p.lin_rel(Pose(z=40), "linRel(0, 0, 40)", cart_velocity_mm_s=50)
    p.load(gripper.with_one(casting.moved(190)), "casting.attachTo")
    p.wait(0.4, "milliSleep(400)")
    p.lin_rel(Pose(z=-40), "linRel(0, 0, -40)", cart_velocity_mm_s=50)
    p.ptp("Scale", "ptp(scale)", velocity_rel=0.25)
    p.lin("Scale", "gripper.move(lin(scale)")
    p.load(None, "casting.detach")
    p.wait(0.8, "milliSleep(800)")
    p.lin("Crate/Pick", 'getFrame("/Side").move', tool="DoubleGripper/Side", cart_velocity_mm_s=200)
    p.load(probe, "probe.attachTo")
    p.ptp([0.2, 0.5, 0, -1.3, 0, 1.1, 0], "ptp(0.2, 0.5")
    p.lin("Scale", "getDefaultMotionFrame().move", tool="Probe", cart_velocity_mm_s=100)
    p.lin("Crate/Above", "getFlange().move", tool="flange")
    return p


def paths(folder: Path) -> Program:
    nozzle = Tool({"Outlet": deg(0, 35, 128, 0, 25, 0)}, Load(0.9, (0, 6, 55)))
    taught = {
        "Start": (Pose(20, 15, 60, -2.533, 0.003, 3.136), 0.1),
        "Via": (Pose(62.5, 48, 60.5, -2.523, 0.002, 3.137), 0.11),
        "End": (Pose(110, 18, 59.5, -2.513, 0.004, 3.135), 0.12),
        "Round1": (Pose(124, 52, 60, -2.523, 0.003, 3.136), 0.12),
        "Round2": (Pose(92, 78, 60, -2.533, 0.002, 3.137), 0.11),
    }
    lid = {
        f"Lid/{name}": Frame(pose, e1, 2, "Nozzle/Outlet") for name, (pose, e1) in taught.items()
    }
    station = Station({"Lid": Frame(deg(540, 40, 160, -70, 0.2, 0.1)), **lid}, {"Nozzle": nozzle})
    p = Program(folder, station, "Sealing", "Nozzle")
    p.ptp("Lid/Start", 'ptp(lid("/Start"))')
    p.lin_rel(Pose(z=20), "linRel(0, 0, 20)", cart_velocity_mm_s=40)
    p.lin_rel(
        Pose(x=30),
        "linRel(30, 0, 0, lid)",
        cart_velocity_mm_s=80,
        **{"in": {**Pose().keys(), "base": "Lid"}},
    )
    p.lin_rel(deg(0, 0, -20, 0, 10, 0), "Transformation.ofDeg(0, 0, -20")
    p.lin_rel(Pose(z=15), "getRootFrame()", **{"in": {**Pose().keys(), "base": "robot"}})
    p.lin("Lid/Start", 'lin(lid("/Start")).setOrientationType', orientation="constant")
    arc = {"aux": "Lid/Via", "frame": "Lid/End", "orientation_reference": "path"}
    p.path("circ", 'circ(lid("/Via"), lid("/End"))', **arc, cart_velocity_mm_s=60)
    arc = {"aux": "Lid/Via", "frame": "Lid/Start"}
    p.path(
        "circ",
        'circ(lid("/Via"), lid("/Start")).set',
        **arc,
        velocity_rel=0.5,
        cart_velocity_mm_s=60,
    )
    p.path("spl", 'spl(lid("/Via"))', frame="Lid/Via", cart_velocity_mm_s=100)
    edge = [
        {"type": "lin", "frame": "Lid/End"},
        {"type": "spl", "frame": "Lid/Round1"},
        {"type": "spl", "frame": "Lid/Round2", "cart_velocity_mm_s": 45},
        {"type": "circ", "frame": "Lid/Start", "aux": "Lid/Via"},
    ]
    p.path(
        "spline",
        "nozzle.move(edge)",
        segments=edge,
        cart_velocity_mm_s=90,
        cart_acceleration_mm_s2=800,
    )
    p.lin_rel(Pose(z=-40), "linRel(0, 0, -40)", orientation_velocity_deg_s=exact_deg(radians(20)))
    return p


def batches(folder: Path) -> Program:
    station = Station(
        frames={
            "Vice": Frame(deg(470, -60, 160, 20, 0, 0)),
            "Vice/Near": Frame(Pose(12.5, -35, 70, 2.2, 0.006, 3.133), -0.05, 2, "Spindle/Bit"),
            "Vice/Far": Frame(Pose(14, 65, 71, 2.21, 0.005, 3.134), -0.09, 2, "Spindle/Bit"),
        },
        tools={
            "Spindle": Tool(
                {"Bit": deg(0, 0, 165, 15, 0, 0)}, Load(1.75, (0, 0, 71), (0.004, 0.004, 0.0015))
            )
        },
    )
    p = Program(folder, station, "Deburring", "Spindle")
    ready = [0, 0.4, 0, -1.5, 0, 1.2, 0]
    there = "spindle.move(there)"
    p.ptp(ready, there, velocity_rel=0.5, blend={"sunrise_rel": 0.3})
    p.ptp("Vice/Near", there, velocity_rel=0.2, blend={"sunrise_rel": 0.3})
    p.lin("Vice/Far", there, velocity_rel=0.5, cart_velocity_mm_s=90)
    inner = "spindle.move(batch("
    p.lin_rel(Pose(z=-30), inner, blend={"cart_mm": 12})
    p.lin_rel(Pose(y=50), inner, blend={"cart_mm": 5})
    p.lin_rel(Pose(z=30), inner)
    polish = "spindle.move(polish)"
    for number, (frame, velocity) in enumerate(
        [("Near", 70), ("Far", None), ("Near", 90), ("Far", None)], 1
    ):
        blend = {"cart_mm": 2} if number < 4 else None
        p.lin(
            f"Vice/{frame}", polish, acceleration_rel=0.75, cart_velocity_mm_s=velocity, blend=blend
        )
    p.lin("Vice/Near", "moveAsync(new MotionBatch", blend={"cart_mm": 8})
    p.lin("Vice/Far", "moveAsync(new MotionBatch", blend={"cart_mm": 8})
    p.ptp(ready, "spindle.move(ptp(0", velocity_rel=0.5)
    return p

package iiwasim.sunrise;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertFalse;
import static org.junit.Assert.assertNull;
import static org.junit.Assert.assertTrue;
import static org.junit.Assert.fail;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;
import com.kuka.connectivity.fastRobotInterface.FRIChannelInformation.FRISessionState;
import com.kuka.connectivity.fastRobotInterface.FRISession;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseSafetyState.SafetyStopType;
import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.deviceModel.OperationMode;
import com.kuka.roboticsAPI.executionModel.CommandInvalidException;
import com.kuka.roboticsAPI.motionModel.ErrorHandlingAction;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;

import iiwasim.program.Log;
import iiwasim.program.Program;
import iiwasim.program.Settings;

import org.junit.After;
import org.junit.Test;

import java.io.ByteArrayInputStream;
import java.io.IOException;
import java.util.ArrayList;

/** The robot program with a stub robot: calls of the controller, and messages to the drive. */
public class SunriseBackendTest {
    private static final long LONG_MS = 20000;
    private static final String TOOLS =
        "'tools':{'gripper':{'tcp':{'z_mm':120},'tips':{'left':{'z_mm':130}}}},'tool':'gripper',";
    private static final String FRAME =
        "{'x_mm':500,'y_mm':0,'z_mm':400,'a_deg':0,'b_deg':0,'c_deg':0,'e1_deg':0,'status':2}";

    private final FakeRobot robot = new FakeRobot();
    private SunriseBackend backend;
    private Program program;

    private void open(String settings) throws IOException {
        String all = "fri_client = 10.0.0.5\n" + settings;
        Settings read = Settings.read(new ByteArrayInputStream(all.getBytes("UTF-8")), "test");
        Log silent = new Log() {
            @Override
            public void info(String text) {
                // Not read.
            }

            @Override
            public void warn(String text) {
                // Not read.
            }
        };
        FRISession.CALLS.clear();
        FRISession.state = FRISessionState.MONITORING_READY;
        backend = new SunriseBackend(robot, robot, robot, read, silent);
        program = new Program(backend, 1, new Program.Clock() {
            @Override
            public long nanoTime() {
                return System.nanoTime();
            }
        });
    }

    @After
    public void close() {
        if (backend != null) {
            backend.close();
        }
    }

    private String ask(String instruction) {
        return program.instruct(instruction.replace('\'', '"'));
    }

    private String error(String instruction) {
        JsonValue error = Json.parse(ask(instruction)).asObject().get("error");
        return error == null ? null : error.asObject().getString("code", "") + ": "
            + error.asObject().getString("message", "");
    }

    private void run(String more, String motions) {
        assertNull(error(
            "{'seq':1,'type':'run_motions','run':7," + more + "'motions':[" + motions + "]}"));
        assertNull(error("{'seq':2,'type':'begin','run':7}"));
    }

    private static String ptp(double deg) {
        return "{'type':'ptp','joints_deg':[" + deg + ",0,0,0,0,0,0]}";
    }

    private JsonObject state() {
        return Json.parse(program.state()).asObject();
    }

    private interface Condition {
        boolean holds();
    }

    private static void await(String what, Condition condition) throws InterruptedException {
        long until = System.nanoTime() + LONG_MS * 1000000;
        while (!condition.holds()) {
            assertTrue("no " + what, System.nanoTime() < until);
            Thread.sleep(5);
        }
    }

    private void awaitContainers(final int count) throws InterruptedException {
        await("container", new Condition() {
            @Override
            public boolean holds() {
                return robot.containers.size() >= count;
            }
        });
        assertEquals(count, robot.containers.size());
    }

    /** Waits for the end of a run, and returns its error; empty without an error. */
    private String end() throws InterruptedException {
        await("end", new Condition() {
            @Override
            public boolean holds() {
                return state().getString("state", "").equals("idle");
            }
        });
        JsonObject outcome = state().get("outcome").asObject();
        assertEquals(7, outcome.getInt("run", 0));
        // The time on the FRI clock is unknown.
        assertNull(outcome.get("end_s"));
        JsonValue error = outcome.get("error");
        return error == null ? "" : error.asObject().getString("message", "");
    }

    @Test
    public void motionsBecomeOneBatch() throws Exception {
        open("");
        run("", "{'type':'ptp','joints_deg':[10,0,0,0,0,0,0],'velocity_rel':0.5,"
            + "'blend':{'fraction':0.25}},"
            + "{'type':'ptp','joints_deg':[20,0,0,0,0,0,0],'velocity_rel':[1,1,1,1,1,1,0.5],"
            + "'jerk_rel':0.3,'acceleration_rel':[1,1,1,1,1,0.9,1],'blend':{'cart_mm':30}},"
            + ptp(0));
        awaitContainers(1);
        String what = robot.containers.get(0).what;
        assertEquals("flange: MotionBatch motion(PTP to(0.17453292519943295..0.0) "
            + "setJointVelocityRel(0.5) setBlendingRel(0.5))"
            + " motion(PTP to(0.3490658503988659..0.0) setJointVelocityRel([1.0, 1.0, 1.0, 1.0, "
            + "1.0, 1.0, 0.5])"
            + " setJointAccelerationRel([1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 1.0]) setJointJerkRel(0.3) "
            + "setBlendingCart(30.0))"
            + " motion(PTP to(0.0..0.0))", what);
        assertEquals("running_motion", state().getString("state", ""));
        robot.containers.get(0).finish(null);
        assertEquals("", end());
    }

    @Test
    public void waitsDivideBatchesAndLastBlendsAreLeftOut() throws Exception {
        open("batch = 2\n");
        run("", ptp(1) + "," + ptp(2) + "," + ptp(3) + ",{'type':'wait','seconds':0.05},"
            + "{'type':'ptp','joints_deg':[4,0,0,0,0,0,0],'blend':{'sunrise_rel':0.5}}");
        // Two batches are queued, so that the robot does not stop between them.
        awaitContainers(2);
        robot.containers.get(0).finish(null);
        robot.containers.get(1).finish(null);
        awaitContainers(3);
        // Sunrise would stop at the blend start.
        assertFalse(robot.containers.get(2).what,
            robot.containers.get(2).what.contains("Blending"));
        robot.containers.get(2).finish(null);
        assertEquals("", end());
    }

    @Test
    public void pathsMoveThePointOfTheTool() throws Exception {
        open("tool = gripper\n");
        run(TOOLS, "{'type':'ptp','frame':" + FRAME + ",'blend':{'cart_mm':30}},"
            + "{'type':'lin','frame':" + FRAME
            + ",'cart_velocity_mm_s':250,'cart_acceleration_mm_s2':1000,'cart_jerk_mm_s3':9000,"
            + "'orientation_velocity_deg_s':180,'orientation':'constant',"
            + "'blend':{'cart_mm':20,'ori_deg':180}},"
            + "{'type':'lin_rel','offset':{'z_mm':-5},'velocity_rel':0.1},"
            + "{'type':'circ','aux':" + FRAME + ",'frame':" + FRAME
            + ",'orientation_reference':'path'},"
            + "{'type':'spl','frame':" + FRAME + "},"
            + "{'type':'spline','cart_velocity_mm_s':100,'segments':[{'type':'spl','frame':" + FRAME
            + "},"
            + "{'type':'lin','frame':" + FRAME + ",'cart_velocity_mm_s':50}]},"
            + "{'type':'lin','frame':" + FRAME + ",'tool':'gripper/left'}");
        awaitContainers(1);
        String what = robot.containers.get(0).what;
        String frame = "[500.0, 0.0, 400.0, 0.0, 0.0, 0.0] e1 0.0 status 2 turn null";
        assertTrue(what, what.startsWith(
            "gripper: MotionBatch motion(CartesianPTP to(" + frame + ") setBlendingCart(30.0))"
            + " motion(LIN to(" + frame
            + ") setOrientationType(Constant) setCartVelocity(250.0) setCartAcceleration(1000.0)"
            + " setCartJerk(9000.0) setOrientationVelocity(3.141592653589793) "
            + "setBlendingCart(20.0) setBlendingOri(3.141592653589793))"
            + " motion(RelativeLIN to([0.0, 0.0, -5.0, 0.0, 0.0, 0.0]) "
            + "setOrientationType(VariableOrientation)"
            + " setJointVelocityRel(0.1))"
            + " motion(CIRC to(" + frame + " and " + frame + ") setOrientationReferenceSystem(Path)"
            + " setOrientationType(VariableOrientation)) motion(SPL"));
        assertTrue(what, what.contains(
            "Spline segment(SPL to(" + frame + ") setOrientationType(VariableOrientation)"
            + " setCartVelocity(100.0)) segment(LIN to(" + frame
            + ") setOrientationType(VariableOrientation) setCartVelocity(50.0))"));
        robot.containers.get(0).finish(null);
        awaitContainers(2);
        assertTrue(robot.containers.get(1).what, robot.containers.get(1).what.startsWith("left: "));
        robot.containers.get(1).finish(null);
        assertEquals("", end());
        assertTrue(robot.points.containsKey("attached"));
    }

    @Test
    public void whatHasNoCounterpartIsRefused() throws Exception {
        open("tool = gripper\n");
        String[][] cases = {
            {TOOLS, "{'type':'lin_rel','offset':{'z_mm':-5},'e1_deg':3}", "e1_deg"},
            {TOOLS, "{'type':'circ','aux':" + FRAME + ",'frame':" + FRAME + ",'circ_angle_deg':90}",
            "circ_angle_deg"},
            {TOOLS, "{'type':'circ','aux':" + FRAME + ",'frame':" + FRAME
            + ",'aux_orientation':'ignore'}", "aux_orientation"},
            {TOOLS.replace("120", "121"), "{'type':'lin','frame':" + FRAME + "}", "1.0 mm"},
            {TOOLS.replace("gripper", "drill"), "{'type':'lin','frame':" + FRAME + "}", "`drill`"},
            {TOOLS.replace("left", "right"), "{'type':'lin','frame':" + FRAME
            + ",'tool':'gripper/right'}", "/right"},
            {TOOLS, "{'type':'lin','frame':" + FRAME
            + ",'blend':{'cart_mm':30}},{'type':'lin','frame':" + FRAME
                + ",'tool':'flange'}", "motion 2"},
            {"", ptp(1) + ",{'type':'load','load':{'mass_kg':2}}",
            "motion 2: a change of the load"},
            {"'mode':'t1',", ptp(1), "T1"},
            {"", ptp(179), "limit"},
        };
        for (String[] row : cases) {
            String error = error(
                "{'seq':1,'type':'run_motions','run':7," + row[0] + "'motions':[" + row[1] + "]}");
            assertTrue(row[1] + ": " + error, error != null && error.contains(row[2]));
        }
        robot.mode = OperationMode.T1;
        assertNull(error(
            "{'seq':1,'type':'run_motions','run':7,'mode':'t1','motions':[" + ptp(1) + "]}"));
        assertTrue(robot.containers.isEmpty());
    }

    @Test
    public void nothingBeginsUnlessTheRobotIsReady() throws Exception {
        open("");
        String instruction = "{'seq':1,'type':'run_motions','run':7,'motions':[" + ptp(1) + "]}";
        robot.stop = SafetyStopType.STOP1;
        assertTrue(error(instruction).contains("STOP1"));
        robot.stop = SafetyStopType.NOSTOP;
        robot.isReady = false;
        assertTrue(error(instruction).contains("not ready"));
        robot.isReady = true;
        robot.isMastered = false;
        assertTrue(error(instruction).contains("mastered"));
        robot.isMastered = true;
        assertNull(error(instruction));
        robot.isReady = false;
        assertTrue(error("{'seq':2,'type':'begin','run':7}").contains("not ready"));
        assertTrue(robot.containers.isEmpty());
    }

    @Test
    public void theControllersRefusalIsPassedOn() throws Exception {
        open("");
        assertNull(error("{'seq':1,'type':'run_motions','run':7,'motions':[" + ptp(1) + "]}"));
        robot.refusal = new CommandInvalidException("workspace error");
        assertTrue(error("{'seq':2,'type':'begin','run':7}").contains("workspace error"));
        assertEquals("idle", state().getString("state", ""));
        robot.refusal = null;
        // The second of two batches is refused: the first is cancelled.
        String motions = ptp(1) + ",{'type':'wait','seconds':0}," + ptp(2);
        assertNull(error("{'seq':1,'type':'run_motions','run':7,'motions':[" + motions + "]}"));
        robot.refuseAfter = 1;
        assertNull(error("{'seq':2,'type':'begin','run':7}"));
        awaitContainers(1);
        robot.containers.get(0).finish(null);
        assertTrue(end().contains("workspace error"));
        robot.containers.clear();
        robot.refuseAfter = Integer.MAX_VALUE;
        robot.refusal = null;
        run("", ptp(1));
        awaitContainers(1);
        robot.containers.get(0).finish("the path cannot be planned");
        assertTrue(end().contains("the path cannot be planned"));
        // The next run begins.
        run("", ptp(1));
        awaitContainers(2);
        robot.containers.get(1).finish(null);
        assertEquals("", end());
    }

    @Test
    public void everyStopEndsTheRunAndNothingGoesOn() throws Exception {
        open("batch = 1\n");
        String[] expected =
            {"stopped on request", "STOP0", "paused", "smartPAD", "lost drive enable"};
        for (int i = 0; i < expected.length; i++) {
            robot.containers.clear();
            run("", ptp(1) + "," + ptp(2) + ",{'type':'wait','seconds':0.01}," + ptp(3));
            awaitContainers(2);
            switch (i) {
                case 0:
                    assertNull(error("{'seq':3,'type':'stop'}"));
                    break;
                case 1:
                    robot.stop = SafetyStopType.STOP0;
                    break;
                case 2:
                    robot.isPaused = true;
                    break;
                case 3:
                    backend.abort("the robot program was paused on the smartPAD");
                    break;
                default:
                    IMotionContainer failed = robot.containers.get(0);
                    robot.containers.get(0).finish("lost drive enable");
                    assertEquals(ErrorHandlingAction.Ignore,
                        robot.errorHandler.handleError(
                        null, failed, new ArrayList<IMotionContainer>()));
            }
            assertTrue(expected[i], end().contains(expected[i]));
            assertTrue(robot.containers.get(1).isCancelled);
            assertEquals(2, robot.containers.size());
            robot.stop = SafetyStopType.NOSTOP;
            robot.isPaused = false;
            Thread.sleep(250);
            assertEquals("nothing is resumed", 2, robot.containers.size());
        }
    }

    @Test
    public void aStopInAWaitIsServed() throws Exception {
        open("");
        run("", ptp(1) + ",{'type':'wait','seconds':3600}," + ptp(2));
        awaitContainers(1);
        robot.containers.get(0).finish(null);
        Thread.sleep(20);
        assertEquals("running_motion", state().getString("state", ""));
        assertNull(error("{'seq':3,'type':'stop'}"));
        assertTrue(end().contains("stopped"));
        assertEquals(1, robot.containers.size());
    }

    private void openFri() throws InterruptedException {
        backend.openFri(null);
        await("session", new Condition() {
            @Override
            public boolean holds() {
                return FRISession.CALLS.contains("open 10.0.0.5:30200");
            }
        });
    }

    @Test
    public void trajectoriesAreLaidOverAHold() throws Exception {
        open("");
        String begin = "{'seq':1,'type':'run_trajectory','run':7}";
        assertTrue(error(begin).contains("FRI is not ready"));
        openFri();
        assertNull(error(begin));
        awaitContainers(1);
        assertEquals("robot: PositionHold for(-1) addMotionOverlay(overlay)",
            robot.containers.get(0).what);
        FRISession.state = FRISessionState.COMMANDING_ACTIVE;
        final IMotionContainer hold = robot.containers.get(0);
        // A controller that reports the end of the hold as an error.
        robot.onCancel = new Runnable() {
            @Override
            public void run() {
                robot.errorHandler.handleError(null, hold, new ArrayList<IMotionContainer>());
            }
        };
        assertNull(error("{'seq':2,'type':'end_trajectory','run':7}"));
        assertEquals("", end());
        // The hold ends with the trajectory: the brakes close.
        assertTrue(robot.containers.get(0).isCancelled);
    }

    @Test
    public void aTrajectoryThatEndsInMotionIsAnError() throws Exception {
        open("");
        openFri();
        FRISession.state = FRISessionState.COMMANDING_ACTIVE;
        assertNull(error("{'seq':1,'type':'run_trajectory','run':7}"));
        final boolean[] isMoving = {true};
        Thread mover = new Thread() {
            @Override
            public void run() {
                for (int i = 0; isMoving[0]; i++) {
                    robot.joints = new JointPosition(i * 0.01, 0, 0, 0, 0, 0, 0);
                    Thread.yield();
                }
            }
        };
        mover.start();
        assertNull(error("{'seq':2,'type':'end_trajectory','run':7}"));
        String error = end();
        isMoving[0] = false;
        mover.join();
        assertTrue(error, error.contains("while the arm moved"));
        assertTrue(robot.containers.get(0).isCancelled);
    }

    @Test
    public void aSessionThatLeavesCommandingEndsTheTrajectory() throws Exception {
        open("");
        openFri();
        FRISession.state = FRISessionState.COMMANDING_ACTIVE;
        assertNull(error("{'seq':1,'type':'run_trajectory','run':7}"));
        Thread.sleep(250);
        FRISession.state = FRISessionState.MONITORING_READY;
        assertTrue(end().contains("left active commanding"));
    }

    @Test
    public void closingCancelsAndCloses() throws Exception {
        open("");
        openFri();
        run("", ptp(1));
        awaitContainers(1);
        backend.close();
        assertTrue(robot.containers.get(0).isCancelled);
        assertTrue(FRISession.CALLS.contains("close"));
        for (Thread thread : Thread.getAllStackTraces().keySet()) {
            if (thread.getName().startsWith("iiwasim")) {
                fail(thread.getName() + " is left");
            }
        }
    }

    @Test
    public void whatEndsBeginsNothing() throws Exception {
        open("");
        openFri();
        run("", ptp(1));
        awaitContainers(1);
        backend.end("the robot program is being ended");
        assertTrue(end().contains("being ended"));
        assertNull(error("{'seq':1,'type':'run_motions','run':8,'motions':[" + ptp(1) + "]}"));
        assertTrue(error("{'seq':2,'type':'begin','run':8}").contains("is ending"));
        assertTrue(error("{'seq':3,'type':'run_trajectory','run':9}").contains("is ending"));
        assertEquals(1, robot.containers.size());
    }

    @Test
    public void sensorsSignalsAndConditions() throws Exception {
        open("output.MediaFlange.LEDBlue = boolean\ninput.MediaFlange.Count = unsigned "
            + "8\noutput.Gripper.Force = analog 16 0 100\n"
            + "output.Gripper.Mode = unsigned 2\n");
        assertTrue(ask("{'seq':1,'type':'read_sensors'}")
            .contains("\"joint_temperature_c\":null,\"external_torque_nm\":[1,2,3,4,5,6,7]"));
        assertTrue(ask("{'seq':1,'type':'list_io'}")
            .contains("{\"name\":\"MediaFlange.Count\",\"direction\":\"input\",\"value\":0}"));
        assertTrue(ask("{'seq':1,'type':'set_io','name':'MediaFlange.LEDBlue','value':true}")
            .contains("\"value\":true"));
        assertTrue(ask("{'seq':1,'type':'set_io','name':'Gripper.Force','value':50}")
            .contains("\"value\":50.0"));
        assertTrue(ask("{'seq':1,'type':'set_io','name':'Gripper.Mode','value':3}")
            .contains("\"value\":3"));
        for (String wrong : new String[] {"'MediaFlange.LEDBlue','value':1",
            "'MediaFlange.Count','value':1",
            "'Gripper.Force','value':101", "'Gripper.Mode','value':4", "'Gripper.Mode','value':0.5",
            "'Gripper.Mode','value':true",
            "'x','value':true"}) {
            String error = error("{'seq':1,'type':'set_io','name':" + wrong + "}");
            assertTrue(wrong + error, error != null && error.startsWith("bad_request"));
        }
        await("conditions", new Condition() {
            @Override
            public boolean holds() {
                return state().get("conditions") != null;
            }
        });
        assertEquals("{\"operation_mode\":\"aut\",\"override\":0.8,\"safety_stop\":false}", state()
            .get("conditions").toString());
    }
}

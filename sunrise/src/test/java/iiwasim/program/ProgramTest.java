package iiwasim.program;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertTrue;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;

import org.junit.Test;

import java.io.File;
import java.io.IOException;
import java.util.Arrays;
import java.util.Collections;
import java.util.List;
import java.util.Scanner;

public class ProgramTest {
    private static final String RUN = "{\"seq\":1,\"type\":\"run_motions\",\"run\":7,\"motions\":"
        + "[{\"type\":\"ptp\",\"joints_deg\":[5,0,0,0,0,0,0]}]}";

    private final Recorder backend = new Recorder();
    private long nowNs;
    private final Program program = new Program(backend, 42, new Program.Clock() {
        @Override
        public long nanoTime() {
            return nowNs;
        }
    });

    /** A robot that does not move and records its calls. */
    static class Recorder implements Backend {
        String calls = "";
        Refusal refusal;
        RuntimeException failure;
        Listener listener;

        private void call(String name) throws Refusal {
            calls += name + " ";
            if (refusal != null) {
                throw refusal;
            }
            if (failure != null) {
                throw failure;
            }
        }

        @Override
        public void checkReady() throws Refusal {
            call("ready");
        }

        @Override
        public Plan plan(MotionList motions) throws Refusal {
            call("plan");
            return new Plan() {
                @Override
                public void begin(Listener whom) throws Refusal {
                    listener = whom;
                    call("begin");
                }
            };
        }

        @Override
        public void beginCommanding(Listener whom) throws Refusal {
            listener = whom;
            call("command");
        }

        @Override
        public void endCommanding() throws Refusal {
            call("end");
        }

        @Override
        public void stop() throws Refusal {
            call("stop");
        }

        @Override
        public Sensors sensors() throws Refusal {
            return new Sensors(null, new double[7]);
        }

        @Override
        public List<Signal> signals() {
            return Collections.singletonList(new Signal("a.b", true, SignalValue.of(0.0)));
        }

        @Override
        public SignalValue get(String name) {
            return SignalValue.of(3L);
        }

        @Override
        public SignalValue set(String name, SignalValue value) {
            return value;
        }

        @Override
        public Conditions conditions() {
            return new Conditions("t1", 0.5, false, "gripper");
        }

        @Override
        public boolean isSimulated() {
            return false;
        }

        @Override
        public String sunriseVersion() {
            return "1.16";
        }

    @Override
    public RobotIdentity robot() {
        return RobotIdentity.of("lbr_iiwa_14_r820", 126);
    }

        @Override
        public void close() {
            calls += "close ";
        }
    }

    private JsonObject ask(String text) {
        return Json.parse(program.instruct(text)).asObject();
    }

    private String code(String text) {
        JsonValue error = ask(text).get("error");
        return error == null ? "" : error.asObject().getString("code", "");
    }

    private JsonObject state() {
        return Json.parse(program.state()).asObject();
    }

    private static String of(String type) {
        return "{\"seq\":2,\"type\":\"" + type + "\",\"run\":7}";
    }

    @Test
    public void motionsArePlannedAndBeginThen() {
        assertEquals("{\"seq\":1}", program.instruct(RUN));
        assertEquals("ready plan ", backend.calls);
        assertEquals("idle", state().getString("state", ""));
        assertEquals("", code(of("begin")));
        assertEquals("ready plan ready begin ", backend.calls);
        assertEquals("running_motion", state().getString("state", ""));
        assertEquals(7, state().getInt("run", 0));
        assertEquals("not_idle", code(RUN));
        assertEquals("not_idle", code(of("run_trajectory")));
        backend.listener.ended(Outcome.timed(1.0, 2.5, null));
        assertEquals("{\"run\":7,\"start_s\":1,\"end_s\":2.5}", state().get("outcome").toString());
        assertEquals("idle", state().getString("state", ""));
        // A run ends only once.
        backend.listener.ended(Outcome.untimed(Refusal.robot("again")));
        assertTrue(state().get("outcome").asObject().get("error") == null);
    }

    @Test
    public void aPlanExpiresAndIsReplaced() {
        ask(RUN);
        nowNs += 1900000000L;
        ask(RUN.replace("\"run\":7", "\"run\":8"));
        assertEquals("robot", code(of("begin")));
        ask(RUN);
        nowNs += 2100000000L;
        assertEquals("robot", code(of("begin")));
        ask(RUN);
        ask("{\"seq\":3,\"type\":\"stop\"}");
        assertEquals("robot", code(of("begin")));
        assertTrue(backend.calls, !backend.calls.contains("begin")
            && !backend.calls.contains("stop"));
    }

    @Test
    public void whatTheRobotRefusesLeavesItIdle() {
        ask(RUN);
        backend.refusal = new Refusal(Refusal.Code.ROBOT, "no");
        long changes = program.changes();
        assertEquals("robot", code(of("begin")));
        assertEquals("robot", code(of("run_trajectory")));
        assertEquals("robot", code(RUN));
        assertEquals("idle", state().getString("state", ""));
        backend.refusal = null;
        backend.failure = new IllegalStateException("it broke");
        assertEquals("robot", code(RUN));
        assertTrue(ask(of("run_trajectory")).toString().contains("it broke"));
        assertEquals("idle", state().getString("state", ""));
        // Not even temporarily: a drive takes a state with the run number as the beginning of the
        // run.
        assertEquals(changes, program.changes());
    }

    @Test
    public void onlyTheTrajectoryThatRunsIsEnded() {
        assertEquals("", code(of("end_trajectory")));
        assertEquals("", code(of("run_trajectory")));
        assertEquals("", code("{\"seq\":2,\"type\":\"end_trajectory\",\"run\":8}"));
        assertEquals("ready command ", backend.calls);
        assertEquals("running_trajectory", state().getString("state", ""));
        assertEquals("", code(of("end_trajectory")));
        assertEquals("", code("{\"seq\":2,\"type\":\"stop\"}"));
        assertEquals("ready command end stop ", backend.calls);
    }

    @Test
    public void statesSayWhoSpeaksAndUnderWhichConditions() {
        JsonObject state = state();
        assertEquals(42, state.getInt("boot", 0));
        assertEquals("{\"operation_mode\":\"t1\",\"override\":0.5,\"safety_stop\":false,"
                + "\"tool\":\"gripper\"}",
            state.get("conditions").toString());
        assertEquals("1.16", state.get("hello").asObject().getString("sunrise", ""));
        assertEquals("{\"model\":\"lbr_iiwa_14_r820\",\"lengths_mm\":{\"base\":360,"
                + "\"upper_arm\":420,\"forearm\":400,\"flange\":126}}",
            state.get("hello").asObject().get("robot").toString());
        assertEquals(Program.PROTOCOL, state.get("hello").asObject().getInt("protocol", 0));
        // Only a simulated robot reports this: clients move its joints without confirmation.
        assertTrue(state.get("simulated") == null);
        long changes = program.changes();
        ask(of("run_trajectory"));
        assertEquals(changes + 1, program.changes());
    }

    /** The version equals the version of the drive in the same release. */
    @Test
    public void theVersionIsThatOfTheWorkspace() throws Exception {
        String version = Program.VERSION.replace("iiwasim ", "");
        assertTrue(read("pom.xml").contains(
            "<artifactId>robot-program</artifactId>\n  <version>" + version + "</version>"));
        assertTrue(read("../Cargo.toml")
            .contains("[workspace.package]\nversion = \"" + version + "\""));
    }

    private static String read(String file) throws IOException {
        return new Scanner(new File(file), "UTF-8").useDelimiter("\\A").next();
    }

    @Test
    public void valuesKeepTheirTypes() {
        assertEquals("{\"seq\":2,\"sensors\":{\"joint_temperature_c\":null,"
                + "\"external_torque_nm\":[0,0,0,0,0,0,0]}}",
            program.instruct("{\"seq\":2,\"type\":\"read_sensors\"}"));
        assertEquals(
            "{\"seq\":2,\"io\":[{\"name\":\"a.b\",\"direction\":\"output\",\"value\":0.0}]}",
            program.instruct("{\"seq\":2,\"type\":\"list_io\"}"));
        for (String value : new String[] {"true", "3", "0", "-0.5", "2.0"}) {
            String set = "{\"seq\":2,\"type\":\"set_io\",\"name\":\"a.b\",\"value\":" + value + "}";
            assertEquals("{\"seq\":2,\"value\":" + value + "}", program.instruct(set));
        }
    }

    @Test
    public void instructionsOfOtherFormsAreRefused() {
        assertTrue(program.instruct(Arrays.asList("{}", "{}")).contains("one frame"));
        assertTrue(program.instruct((String) null).contains("UTF-8"));
        for (String text : new String[] {"", "{", "[]", "null", "{\"seq\":1}",
            "{\"type\":\"stop\"}", "\u0000",
            "{\"seq\":-1,\"type\":\"stop\"}", "{\"seq\":1e2,\"type\":\"stop\"}",
            "{\"seq\":1,\"type\":\"stop\"} x"}) {
            assertEquals(text, "bad_request", code(text));
            assertTrue(text, ask(text).get("seq").isNull());
        }
    }
}

package iiwasim.program;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertTrue;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonArray;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;

import iiwasim.simulation.SimulatedBackend;

import org.junit.Test;

import java.io.BufferedReader;
import java.io.File;
import java.io.FileInputStream;
import java.io.InputStreamReader;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.Collections;
import java.util.List;
import java.util.concurrent.Callable;
import java.util.concurrent.ExecutorService;
import java.util.concurrent.Executors;
import java.util.concurrent.Future;
import java.util.concurrent.atomic.AtomicInteger;

/**
 * Runs the cases of {@code conformance}, whose format its README defines, on the robot program with
 * a simple robot.
 */
public class ConformanceTest {
    /** Features of the simple robot that cases may require. */
    private static final List<String> HAS = Arrays.asList("motion", "io", "times");

    private final AtomicInteger passed = new AtomicInteger();
    private final AtomicInteger skipped = new AtomicInteger();
    private final List<String> failures = Collections.synchronizedList(new ArrayList<String>());

    /** Runs all files in parallel: each has its own program, and waits most of the time. */
    @Test
    public void allCases() throws Exception {
        ExecutorService threads = Executors.newCachedThreadPool();
        List<Future<?>> running = new ArrayList<Future<?>>();
        for (final File file : new File("conformance").listFiles()) {
            if (file.getName().endsWith(".jsonl")) {
                running.add(threads.submit(new Callable<Void>() {
                    @Override
                    public Void call() throws Exception {
                        run(file);
                        return null;
                    }
                }));
            }
        }
        for (Future<?> one : running) {
            one.get();
        }
        threads.shutdown();
        System.out.println("conformance of the Java program: " + passed + " cases passed, "
            + failures.size() + " failed, "
            + skipped + " skipped");
        assertEquals(failures.toString(), 0, failures.size());
        assertTrue(passed.get() > 1000);
    }

    private void run(File file) throws Exception {
        SimulatedBackend backend = new SimulatedBackend();
        Program program = new Program(backend, 9, new Program.Clock() {
            @Override
            public long nanoTime() {
                return System.nanoTime();
            }
        });
        String instructions = ServerTest.free();
        String states = ServerTest.free();
        Server server =
            new Server(program, instructions, states, Security.open(), ServerTest.SILENT);
        Peer peer = new Peer(instructions, states, null, null);
        BufferedReader lines =
            new BufferedReader(new InputStreamReader(new FileInputStream(file), "UTF-8"));
        try {
            for (String line = lines.readLine(); line != null; line = lines.readLine()) {
                run(file.getName(), Json.parse(line).asObject(), peer);
            }
        } finally {
            lines.close();
            peer.close();
            server.close();
            backend.close();
        }
    }

    private void run(String file, JsonObject one, Peer peer) throws Exception {
        JsonValue needs = one.get("needs");
        for (JsonValue need : needs == null ? new JsonArray() : needs.asArray()) {
            if (!HAS.contains(need.asString())) {
                skipped.incrementAndGet();
                return;
            }
        }
        String failure = null;
        for (JsonValue step : one.get("steps").asArray()) {
            failure = step(step.asObject(), peer);
            if (failure != null) {
                break;
            }
        }
        peer.acknowledgement = "{\"ok\":true}";
        if (failure == null) {
            passed.incrementAndGet();
            return;
        }
        failures.add(file + ": " + one.getString("name", "") + ": " + failure + "\n");
        peer.send("{\"seq\":0,\"type\":\"stop\"}".getBytes("UTF-8"));
        while (peer.answer(0.3) != null) {
            continue;
        }
    }

    /** The failure of a step; null for success. */
    private static String step(JsonObject step, Peer peer) throws Exception {
        String name = step.names().get(0);
        JsonValue value = step.get(name);
        if (name.equals("send")) {
            peer.send(value.toString().getBytes(Peer.UTF_8));
        } else if (name.equals("send_text")) {
            peer.send(value.asString().getBytes(Peer.UTF_8));
        } else if (name.equals("send_hex")) {
            peer.send(bytes(value.asString()));
        } else if (name.equals("send_repeated")) {
            StringBuilder text = new StringBuilder();
            for (int i = 0; i < value.asObject().getInt("times", 0); i++) {
                text.append(value.asObject().getString("text", ""));
            }
            peer.send(text.toString().getBytes(Peer.UTF_8));
        } else if (name.equals("send_frames")) {
            byte[][] frames = new byte[value.asArray().size()][];
            for (int i = 0; i < frames.length; i++) {
                frames[i] = value.asArray().get(i).asString().getBytes(Peer.UTF_8);
            }
            peer.send(frames);
        } else if (name.equals("expect")) {
            JsonValue answer = peer.answer(60);
            return matches(value, answer) ? null : "expected " + value + ", got " + answer;
        } else if (name.equals("expect_in_any_order")) {
            return inAnyOrder(value.asArray(), peer);
        } else if (name.equals("expect_nothing")) {
            JsonValue answer = peer.answer(step.getDouble("within_s", 0));
            return answer == null ? null : "expected nothing, got " + answer;
        } else if (name.equals("state")) {
            return state(value, step.getDouble("within_s", 0), peer);
        } else if (name.equals("acknowledge")) {
            peer.acknowledgement = value.isString() ? "garbage" : value.asBoolean()
                ? "{\"ok\":true}" : null;
        } else if (name.equals("count_states")) {
            return count(value.asObject(), peer);
        } else if (name.equals("pause_s")) {
            Thread.sleep((long) (value.asDouble() * 1000));
        } else {
            return "unknown step " + name;
        }
        return null;
    }

    private static byte[] bytes(String hex) {
        byte[] bytes = new byte[hex.length() / 2];
        for (int i = 0; i < bytes.length; i++) {
            bytes[i] = (byte) Integer.parseInt(hex.substring(2 * i, 2 * i + 2), 16);
        }
        return bytes;
    }

    private static String inAnyOrder(JsonArray patterns, Peer peer) {
        List<JsonValue> left = new ArrayList<JsonValue>(patterns.values());
        for (int i = 0; i < patterns.size(); i++) {
            JsonValue answer = peer.answer(60);
            boolean isFound = false;
            for (int k = 0; k < left.size() && !isFound; k++) {
                isFound = matches(left.get(k), answer);
                if (isFound) {
                    left.remove(k);
                }
            }
            if (!isFound) {
                return "expected one of " + left + ", got " + answer;
            }
        }
        return null;
    }

    private static String state(JsonValue pattern, double withinS, Peer peer)
        throws InterruptedException {
        long until = System.nanoTime() + (long) (withinS * 1e9);
        JsonValue last = null;
        peer.states.clear();
        while (System.nanoTime() < until) {
            JsonValue state = peer.state(0.1);
            if (state != null && matches(pattern, state)) {
                return null;
            }
            last = state == null ? last : state;
        }
        return "expected the state " + pattern + ", got " + last;
    }

    private static String count(JsonObject count, Peer peer) throws InterruptedException {
        peer.states.clear();
        Thread.sleep((long) (1000 * count.getDouble("over_s", 0)));
        int states = peer.states.size();
        boolean isRight = states >= count.getInt("at_least", 0)
            && states <= count.getInt("at_most", Integer.MAX_VALUE);
        return isRight ? null : "expected " + count + ", got " + states;
    }

    static boolean matches(JsonValue pattern, JsonValue value) {
        boolean isAbsent = value == null || value.isNull();
        if (pattern.isNull()) {
            return isAbsent;
        }
        if (pattern.isObject() && pattern.asObject().size() == 1) {
            String key = pattern.asObject().names().get(0);
            JsonValue of = pattern.asObject().get(key);
            if (key.equals("$any")) {
                return value != null;
            }
            if (key.equals("$absent")) {
                return value == null;
            }
            if (key.equals("$has")) {
                return !isAbsent && value.isString() && value.asString().contains(of.asString());
            }
            if (key.equals("$has_any")) {
                for (JsonValue text : of.asArray()) {
                    if (!isAbsent && value.isString() && value.asString()
                        .contains(text.asString())) {
                        return true;
                    }
                }
                return false;
            }
            if (key.equals("$between")) {
                return !isAbsent && value.isNumber() && value.asDouble() >= of.asArray().get(0)
                    .asDouble()
                    && value.asDouble() <= of.asArray().get(1).asDouble();
            }
        }
        if (isAbsent) {
            return false;
        }
        if (pattern.isObject()) {
            for (JsonObject.Member member : pattern.asObject()) {
                if (!value.isObject()
                    || !matches(member.getValue(), value.asObject().get(member.getName()))) {
                    return false;
                }
            }
            return value.isObject();
        }
        if (pattern.isArray()) {
            boolean isSame = value.isArray() && value.asArray().size() == pattern.asArray().size();
            for (int i = 0; isSame && i < pattern.asArray().size(); i++) {
                isSame = matches(pattern.asArray().get(i), value.asArray().get(i));
            }
            return isSame;
        }
        return pattern.isNumber() && value.isNumber() ? sameNumber(pattern, value)
            : pattern.equals(value);
    }

    private static boolean sameNumber(JsonValue a, JsonValue b) {
        return a.toString().equals(b.toString()) || a.asDouble() == b.asDouble();
    }
}

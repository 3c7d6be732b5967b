package iiwasim.simulation;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonArray;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;

import iiwasim.program.Backend;
import iiwasim.program.Conditions;
import iiwasim.program.MotionList;
import iiwasim.program.Outcome;
import iiwasim.program.Refusal;
import iiwasim.program.RobotIdentity;
import iiwasim.program.Sensors;
import iiwasim.program.Signal;
import iiwasim.program.SignalValue;
import iiwasim.program.Threads;

import org.zeromq.ZMQ;
import org.zeromq.ZMQException;

import java.nio.charset.Charset;
import java.util.ArrayList;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.concurrent.CountDownLatch;
import java.util.concurrent.TimeUnit;

/**
 * A robot simulated by an {@code iiwasim cabinet}. This class instructs the cabinet like a drive,
 * with its own instruction numbers, and the cabinet communicates with the drive over FRI.
 */
final class CabinetBackend implements Backend {
    private static final int ANSWER_MS = 5000;
    private static final int PLAN_MS = 60000;
    private static final int POLL_MS = 50;
    private static final Charset UTF_8 = Charset.forName("UTF-8");

    private final ZMQ.Context context = ZMQ.context(1);
    private final ZMQ.Socket instructions;
    private final Thread states;
    private final boolean isTimed;
    private final CountDownLatch connected = new CountDownLatch(1);
    private long seq;
    private long lastRun = System.nanoTime() >>> 20;
    private volatile boolean isClosing;
    private volatile Conditions conditions;

    /** Listeners by the number of their run. */
    private final Map<Long, Listener> running = new HashMap<Long, Listener>();

    /**
     * Connects to a cabinet.
     *
     * @param isTimed true to pass on times and temperatures, which a real robot program does not
     *     know
     */
    CabinetBackend(String instructionsAt, String statesAt, boolean isTimed) {
        this.isTimed = isTimed;
        instructions = context.socket(ZMQ.DEALER);
        instructions.setLinger(0);
        instructions.connect(instructionsAt);
        final ZMQ.Socket rep = context.socket(ZMQ.REP);
        rep.setLinger(0);
        rep.setReceiveTimeOut(POLL_MS);
        rep.connect(statesAt);
        states = new Thread(new Runnable() {
            @Override
            public void run() {
                receiveStates(rep);
            }
        }, "cabinet states");
        states.setDaemon(true);
        states.start();
    }

    /** Waits until the cabinet has sent its state. */
    boolean awaitConnection(int seconds) throws InterruptedException {
        return connected.await(seconds, TimeUnit.SECONDS);
    }

    private void receiveStates(ZMQ.Socket rep) {
        try {
            while (!isClosing) {
                byte[] state = rep.recv();
                if (state != null) {
                    rep.send("{\"ok\":true}");
                    receive(Json.parse(new String(state, UTF_8)).asObject());
                }
            }
        } catch (ZMQException error) {
            isClosing = true;
        } finally {
            rep.close();
        }
    }

    private void receive(JsonObject state) {
        JsonValue seen = state.get("conditions");
        if (seen != null) {
            JsonObject now = seen.asObject();
            JsonValue override = now.get("override");
            JsonValue stop = now.get("safety_stop");
            conditions = new Conditions(now.getString("operation_mode", null),
                override == null ? null : Double.valueOf(override.asDouble()),
                stop == null ? null : Boolean.valueOf(stop.asBoolean()),
                now.getString("tool", null));
        }
        connected.countDown();
        JsonValue outcome = state.get("outcome");
        if (outcome == null) {
            return;
        }
        Listener listener;
        synchronized (running) {
            listener = running.remove(outcome.asObject().getLong("run", -1));
        }
        if (listener != null) {
            listener.ended(outcome(outcome.asObject()));
        }
    }

    private Outcome outcome(JsonObject json) {
        Refusal error = json.get("error") == null ? null : refusal(json.get("error").asObject());
        if (!isTimed || json.get("end_s") == null) {
            return Outcome.untimed(error);
        }
        JsonValue start = json.get("start_s");
        return Outcome.timed(start == null ? null : Double.valueOf(start.asDouble()),
            json.get("end_s").asDouble(), error);
    }

    private static Refusal refusal(JsonObject error) {
        return new Refusal(
            Refusal.Code.of(error.getString("code", "robot")), error.getString("message", ""));
    }

    /** Sends an instruction and waits for its acknowledgement. */
    private JsonObject ask(JsonObject instruction, int withinMs) throws Refusal {
        seq++;
        instruction.set("seq", seq);
        instructions.send("", ZMQ.SNDMORE);
        instructions.send(instruction.toString().getBytes(UTF_8));
        long until = System.nanoTime() + withinMs * 1000000L;
        while (System.nanoTime() < until && !isClosing) {
            instructions.setReceiveTimeOut(POLL_MS);
            byte[] frame = instructions.recv();
            while (frame != null && instructions.hasReceiveMore()) {
                frame = instructions.recv();
            }
            if (frame == null) {
                continue;
            }
            JsonObject answer = Json.parse(new String(frame, UTF_8)).asObject();
            if (!answer.get("seq").isNull() && answer.get("seq").asLong() != seq) {
                continue;
            }
            if (answer.get("error") != null) {
                throw refusal(answer.get("error").asObject());
            }
            return answer;
        }
        throw new Refusal(Refusal.Code.TIMEOUT, "the simulated cabinet does not answer");
    }

    private static JsonObject instruction(String type) {
        return new JsonObject().add("type", type);
    }

    private long listen(Listener listener) {
        synchronized (running) {
            lastRun++;
            running.put(lastRun, listener);
            return lastRun;
        }
    }

    @Override
    public void checkReady() throws Refusal {
        if (conditions != null && conditions.isSafetyStop()) {
            throw Refusal.robot("the emergency stop is pressed");
        }
    }

    @Override
    public Plan plan(MotionList motions) throws Refusal {
        final long run;
        synchronized (running) {
            run = ++lastRun;
        }
        JsonObject instruction = instruction("run_motions").add("run", run);
        for (JsonObject.Member member : motions.source()) {
            if (instruction.get(member.getName()) == null && !member.getName().equals("seq")) {
                instruction.add(member.getName(), member.getValue());
            }
        }
        ask(instruction, PLAN_MS);
        return new Plan() {
            @Override
            public void begin(Listener listener) throws Refusal {
                synchronized (running) {
                    running.put(run, listener);
                }
                askOf(run, instruction("begin"));
            }
        };
    }

    /** Sends an instruction about a run; a refusal removes the listener of the run. */
    private void askOf(long run, JsonObject instruction) throws Refusal {
        boolean isAccepted = false;
        try {
            ask(instruction.add("run", run), ANSWER_MS);
            isAccepted = true;
        } finally {
            if (!isAccepted) {
                synchronized (running) {
                    running.remove(run);
                }
            }
        }
    }

    @Override
    public void beginCommanding(Listener listener) throws Refusal {
        askOf(listen(listener), instruction("run_trajectory"));
    }

    @Override
    public void endCommanding() throws Refusal {
        long run;
        synchronized (running) {
            run = lastRun;
        }
        ask(instruction("end_trajectory").add("run", run), ANSWER_MS);
    }

    @Override
    public void stop() throws Refusal {
        ask(instruction("stop"), ANSWER_MS);
    }

    @Override
    public Sensors sensors() throws Refusal {
        JsonObject sensors = ask(instruction("read_sensors"), ANSWER_MS).get("sensors").asObject();
        JsonValue temperatures = sensors.get("joint_temperature_c");
        boolean isMeasured = isTimed && temperatures != null && !temperatures.isNull();
        return new Sensors(isMeasured ? numbers(temperatures.asArray()) : null,
            numbers(sensors.get("external_torque_nm").asArray()));
    }

    private static double[] numbers(JsonArray values) {
        double[] numbers = new double[values.size()];
        for (int i = 0; i < numbers.length; i++) {
            numbers[i] = values.get(i).asDouble();
        }
        return numbers;
    }

    @Override
    public List<Signal> signals() throws Refusal {
        List<Signal> signals = new ArrayList<Signal>();
        for (JsonValue value : ask(instruction("list_io"), ANSWER_MS).get("io").asArray()) {
            JsonObject signal = value.asObject();
            signals.add(new Signal(
                signal.getString("name", ""), signal.getString("direction", "").equals("output"),
                SignalValue.of(signal.get("value"))));
        }
        return signals;
    }

    @Override
    public SignalValue get(String name) throws Refusal {
        return SignalValue.of(ask(instruction("get_io").add("name", name), ANSWER_MS).get("value"));
    }

    @Override
    public SignalValue set(String name, SignalValue value) throws Refusal {
        JsonObject instruction = instruction("set_io").add("name", name).add("value", value.json());
        return SignalValue.of(ask(instruction, ANSWER_MS).get("value"));
    }

    @Override
    public Conditions conditions() {
        return conditions;
    }

    @Override
    public boolean isSimulated() {
        return true;
    }

    @Override
    public String sunriseVersion() {
        return null;
    }

    @Override
    public RobotIdentity robot() {
        return null;
    }

    @Override
    public void close() {
        isClosing = true;
        Threads.join(states, 2 * POLL_MS + 1000);
        instructions.close();
        context.term();
    }
}

package iiwasim.simulation;

import iiwasim.program.Backend;
import iiwasim.program.Conditions;
import iiwasim.program.Motion;
import iiwasim.program.MotionList;
import iiwasim.program.Outcome;
import iiwasim.program.Refusal;
import iiwasim.program.RobotIdentity;
import iiwasim.program.Sensors;
import iiwasim.program.Signal;
import iiwasim.program.SignalValue;

import java.util.ArrayList;
import java.util.Collections;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;
import java.util.concurrent.Executors;
import java.util.concurrent.ScheduledExecutorService;
import java.util.concurrent.ScheduledFuture;
import java.util.concurrent.ThreadFactory;
import java.util.concurrent.TimeUnit;

/**
 * A robot in pure Java, for protocol tests. The robot stops at each target, the time of a motion is
 * the time that its slowest joint needs at maximum speed, and FRI is missing: during commanding the
 * robot holds its position.
 */
public final class SimulatedBackend implements Backend {
    /** Velocity limits of an LBR iiwa 7 R800, in rad/s. */
    private static final double[] SPEED = radians(98, 98, 100, 130, 140, 180, 180);
    /** Joint ranges of both robots, plus and minus, in rad. */
    private static final double[] RANGE = radians(170, 120, 170, 120, 170, 120, 175);

    private final ScheduledExecutorService clock =
        Executors.newSingleThreadScheduledExecutor(new ThreadFactory() {
        @Override
        public Thread newThread(Runnable task) {
            Thread thread = new Thread(task, "simulated robot");
            thread.setDaemon(true);
            return thread;
        }
    });
    private final Map<String, Signal> signals = new TreeMap<String, Signal>();
    private final long startNs = System.nanoTime();
    private double[] jointsRad = new double[7];
    private Listener listener;
    private ScheduledFuture<?> end;
    private double beganS;

    public SimulatedBackend() {
        for (String input : new String[] {"UserButton", "InputX3Pin3", "InputX3Pin4"}) {
            put("MediaFlange." + input, false, SignalValue.of(false));
        }
        for (String output : new String[] {"LEDBlue", "OutputX3Pin1", "OutputX3Pin2",
            "SwitchOffX3Voltage"}) {
            put("MediaFlange." + output, true, SignalValue.of(false));
        }
        put("Simulation.DigitalInput", false, SignalValue.of(0L));
        put("Simulation.DigitalOutput", true, SignalValue.of(0L));
        put("Simulation.AnalogInput", false, SignalValue.of(0.0));
        put("Simulation.AnalogOutput", true, SignalValue.of(0.0));
    }

    private static double[] radians(double... degrees) {
        double[] radians = new double[degrees.length];
        for (int i = 0; i < degrees.length; i++) {
            radians[i] = Math.toRadians(degrees[i]);
        }
        return radians;
    }

    private void put(String name, boolean isOutput, SignalValue value) {
        signals.put(name, new Signal(name, isOutput, value));
    }

    private double nowS() {
        return (System.nanoTime() - startNs) * 1e-9;
    }

    @Override
    public void checkReady() {
        // The simulated robot is always ready.
    }

    @Override
    public Plan plan(MotionList motions) throws Refusal {
        double takesS = 0;
        double[] at = jointsRad;
        for (Motion motion : motions.motions()) {
            takesS += motion.seconds;
            if (motion.jointsRad == null) {
                continue;
            }
            double slowest = 0;
            for (int j = 0; j < 7; j++) {
                if (Math.abs(motion.jointsRad[j]) > RANGE[j] + 1e-9) {
                    throw new Refusal(Refusal.Code.LIMIT, "motion " + motion.number + ": joint A"
                        + (j + 1) + " is at "
                        + Math.toDegrees(motion.jointsRad[j]) + " deg; its range is +-"
                        + Math.toDegrees(RANGE[j]) + " deg");
                }
                double share = motion.limits.velocityRel() == null ? 1
                    : motion.limits.velocityRel()[j];
                slowest = Math.max(
                    slowest, Math.abs(motion.jointsRad[j] - at[j]) / (SPEED[j] * share));
            }
            takesS += slowest;
            at = motion.jointsRad;
        }
        final double duration = takesS;
        final double[] target = at;
        return new Plan() {
            @Override
            public void begin(Listener listener) {
                start(listener);
                synchronized (SimulatedBackend.this) {
                    end = clock.schedule(new Runnable() {
                        @Override
                        public void run() {
                            synchronized (SimulatedBackend.this) {
                                jointsRad = target;
                            }
                            finish(null);
                        }
                    }, (long) (duration * 1e6), TimeUnit.MICROSECONDS);
                }
            }
        };
    }

    private synchronized void start(Listener whom) {
        listener = whom;
        beganS = nowS();
    }

    private void finish(Refusal error) {
        Listener whom;
        Outcome outcome;
        synchronized (this) {
            whom = listener;
            listener = null;
            outcome = Outcome.timed(beganS, nowS(), error);
            if (end != null) {
                end.cancel(false);
                end = null;
            }
        }
        if (whom != null) {
            whom.ended(outcome);
        }
    }

    @Override
    public void beginCommanding(Listener whom) {
        start(whom);
    }

    @Override
    public void endCommanding() {
        finish(null);
    }

    @Override
    public void stop() {
        finish(Refusal.robot("stopped on request"));
    }

    @Override
    public Sensors sensors() {
        return new Sensors(null, new double[7]);
    }

    @Override
    public List<Signal> signals() {
        return Collections.unmodifiableList(new ArrayList<Signal>(signals.values()));
    }

    private Signal signal(String name) throws Refusal {
        return Signal.find(signals.values(), name);
    }

    @Override
    public SignalValue get(String name) throws Refusal {
        return signal(name).value();
    }

    @Override
    public SignalValue set(String name, SignalValue value) throws Refusal {
        Signal signal = signal(name);
        SignalValue fitting = signal.fitting(value);
        put(name, true, fitting);
        return fitting;
    }

    @Override
    public Conditions conditions() {
        return new Conditions("aut", 1.0, false, null);
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
        return RobotIdentity.of("lbr_iiwa_7_r800", 152);
    }

    @Override
    public void close() {
        finish(Refusal.robot("the robot program has ended"));
        clock.shutdownNow();
    }
}

package iiwasim.program;

import com.eclipsesource.json.JsonValue;

import java.util.Collection;
import java.util.HashMap;
import java.util.Map;
import java.util.TreeMap;
import java.util.TreeSet;

/** Tools, bases and frames by their names, with the tool and base in use. */
final class Workcell {
    private static final String ROBOT = "robot";

    private final Map<String, Pose> tools = new TreeMap<String, Pose>();
    private final Map<String, Map<String, Pose>> tips = new HashMap<String, Map<String, Pose>>();
    private final Map<String, Placed> bases = new TreeMap<String, Placed>();
    private final Map<String, PlacedTarget> frames = new TreeMap<String, PlacedTarget>();
    private final String tool;
    private final String base;
    private final boolean isT1;

    /** A pose in a base. */
    private static final class Placed {
        final Pose pose;
        final String base;

        Placed(Pose pose, String base) {
            this.pose = pose;
            this.base = base;
        }
    }

    /** A target in a base; null for the base of the program or motion. */
    private static final class PlacedTarget {
        final Target target;
        final String base;

        PlacedTarget(Target target, String base) {
            this.target = target;
            this.base = base;
        }
    }

    /**
     * Reads the keys {@code tools}, {@code bases}, {@code frames}, {@code tool}, {@code base},
     * {@code mode} and {@code mount}.
     */
    Workcell(Keys keys) throws Refusal {
        for (String name : keys.namesIn("tools")) {
            check("tool", name, Tcp.FLANGE);
            if (name.indexOf('/') >= 0) {
                throw Refusal.bad("the tool `" + Messages.excerpt(name)
                    + "`: a tool's name has no `/`, which divides tool and tip");
            }
            readTool(name, keys.object("tools").object(name));
        }
        for (String name : keys.namesIn("bases")) {
            check("base", name, ROBOT);
            Keys own = keys.object("bases").object(name);
            Pose pose = pose(own, false);
            bases.put(name, new Placed(pose, own.textIfGiven("base")));
            own.refuseOthers();
        }
        for (String name : keys.namesIn("frames")) {
            check("frame", name, "tcp");
            frames.put(name, placed(keys.object("frames").object(name)));
        }
        tool = keys.textIfGiven("tool");
        base = keys.textIfGiven("base");
        if (keys.isGiven("mount")) {
            // Sunrise knows the mounting of the robot from its own configuration.
            Keys mount = keys.object("mount");
            mount.numbers("rpy_deg", 3);
            mount.refuseOthers();
        }
        isT1 = keys.isGiven("mode") && keys.word("mode", "t1").equals("t1");
        tcp(null);
        base(null);
    }

    /** True if the motions have to keep the speed limit of the operation mode T1. */
    boolean isT1() {
        return isT1;
    }

    private static void check(String kind, String name, String taken) throws Refusal {
        if (name.length() == 0 || name.equals(taken)) {
            throw Refusal.bad("`" + name + "` cannot be the name of a " + kind);
        }
    }

    private void readTool(String name, Keys own) throws Refusal {
        Keys tcp = own.object("tcp");
        tools.put(name, pose(tcp, false));
        tcp.refuseOthers();
        Map<String, Pose> ofTips = new TreeMap<String, Pose>();
        for (String tip : own.namesIn("tips")) {
            if (tip.length() == 0) {
                throw own.wrong("the name of a tip has at least one character");
            }
            Keys keys = own.object("tips").object(tip);
            ofTips.put(tip, pose(keys, false));
            keys.refuseOthers();
        }
        tips.put(name, ofTips);
        if (own.isGiven("load")) {
            readLoad(own.object("load"), false);
        }
        own.refuseOthers();
    }

    /**
     * Validates a load. Its values are not used, as the load of a tool is set in Sunrise.
     *
     * @param hasBody true if the moments of inertia also have to be physically possible
     */
    static void readLoad(Keys load, boolean hasBody) throws Refusal {
        if (load.number("mass_kg") < 0) {
            throw load.wrong("`mass_kg` has to be 0 or more");
        }
        for (String vector : new String[] {"center_mm", "inertia_kg_m2", "abc_deg"}) {
            if (load.has(vector)) {
                for (double number : load.numbers(vector, 3)) {
                    if (hasBody && vector.equals("inertia_kg_m2") && number < 0) {
                        throw load.wrong("`inertia_kg_m2` has to be 0 or more");
                    }
                }
            }
        }
        load.refuseOthers();
    }

    /** Reads a pose; missing numbers are 0, unless {@code needsAll}. */
    static Pose pose(Keys keys, boolean needsAll) throws Refusal {
        double[] numbers = new double[6];
        String[] axes = {"x", "y", "z", "a", "b", "c"};
        for (int i = 0; i < 3; i++) {
            Double length = keys.numberIfGiven(axes[i] + "_mm");
            if (length == null && needsAll) {
                throw keys.wrong("`" + axes[i] + "_mm` is missing");
            }
            numbers[i] = length == null ? 0 : length;
        }
        for (int i = 3; i < 6; i++) {
            Double angle = angle(keys, axes[i]);
            if (angle == null && needsAll) {
                throw keys.wrong("`" + axes[i] + "_deg` is missing");
            }
            numbers[i] = angle == null ? 0 : angle;
        }
        return Pose.of(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]);
    }

    /** An angle in rad, given in rad or in degrees; null if not given. */
    static Double angle(Keys keys, String name) throws Refusal {
        Double deg = keys.numberIfGiven(name + "_deg");
        Double rad = keys.numberIfGiven(name + "_rad");
        if (deg != null && rad != null) {
            throw keys.wrong("give either `" + name + "_deg` or `" + name + "_rad`, not both");
        }
        return deg == null ? rad : Double.valueOf(Math.toRadians(deg));
    }

    private static PlacedTarget placed(Keys keys) throws Refusal {
        Pose pose = pose(keys, true);
        Target target = new Target(pose, angle(keys, "e1"), keys.wholeIfGiven("status", 7),
            keys.wholeIfGiven("turn", 127));
        PlacedTarget placed = new PlacedTarget(target, keys.textIfGiven("base"));
        keys.refuseOthers();
        return placed;
    }

    /** A TCP by its name, {@code TOOL} or {@code TOOL/TIP}; the TCP in use for null. */
    Tcp tcp(String name) throws Refusal {
        String wanted = name != null ? name : tool != null ? tool : Tcp.FLANGE;
        if (wanted.equals(Tcp.FLANGE)) {
            return new Tcp(Tcp.FLANGE, null, Pose.IDENTITY);
        }
        int slash = wanted.indexOf('/');
        String ofTool = slash < 0 ? wanted : wanted.substring(0, slash);
        String tip = slash < 0 ? null : wanted.substring(slash + 1);
        Pose pose = tip == null ? tools.get(ofTool) : tips.containsKey(ofTool) ? tips.get(ofTool)
            .get(tip) : null;
        if (pose == null) {
            throw unknown("tool", wanted, tools.keySet());
        }
        return new Tcp(ofTool, tip, pose);
    }

    /** A base relative to the robot foot, by its name; the base in use for null. */
    private Pose base(String name) throws Refusal {
        String next = name != null ? name : base != null ? base : ROBOT;
        Pose pose = Pose.IDENTITY;
        for (int i = 0; i <= bases.size(); i++) {
            if (next.equals(ROBOT)) {
                return pose;
            }
            Placed placed = bases.get(next);
            if (placed == null) {
                throw unknown("base", next, bases.keySet());
            }
            pose = placed.pose.then(pose);
            next = placed.base == null ? ROBOT : placed.base;
        }
        throw Refusal.bad(
            "the base `" + Messages.excerpt(next) + "` refers to itself through its own base");
    }

    /**
     * The target of a motion key, given by its name or as an object.
     *
     * @param base the base of the motion; null for the base of the program. A target given by its
     *     name always uses the base of the program, so that it is the same place for all motions.
     */
    Target target(Keys motion, String key, String base) throws Refusal {
        JsonValue value = motion.value(key);
        try {
            if (value.isString()) {
                PlacedTarget named = frames.get(value.asString());
                if (named == null) {
                    throw unknown("frame", value.asString(), frames.keySet());
                }
                return named.target.in(base(named.base));
            }
            if (!value.isObject()) {
                throw Refusal.bad(
                    "`" + key + "` has to be a frame, or the name of one, not " + Keys.kind(value));
            }
        } catch (Refusal refusal) {
            throw motion.wrong(refusal.getMessage());
        }
        PlacedTarget given = placed(motion.object(key));
        try {
            return given.target.in(base(given.base == null ? base : given.base));
        } catch (Refusal refusal) {
            throw motion.wrong("`" + key + "`: " + refusal.getMessage());
        }
    }

    /** Fails for an unknown base, even if the motion does not use it. */
    void checkBase(Keys motion, String name) throws Refusal {
        try {
            base(name);
        } catch (Refusal refusal) {
            throw motion.wrong(refusal.getMessage());
        }
    }

    private static Refusal unknown(String kind, String name, Collection<String> known) {
        String listed = known.isEmpty() ? "none"
            : Keys.join(new TreeSet<String>(known).toArray(new String[known.size()]));
        return Refusal.bad(
            "unknown " + kind + " `" + Messages.excerpt(name) + "`; known are " + listed);
    }
}

package iiwasim.program;

import com.eclipsesource.json.JsonValue;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.Locale;

/** Reads motions, and checks everything that can be checked without a robot. */
final class MotionReader {
    private static final String[] TYPES =
        {"ptp", "lin", "lin_rel", "circ", "spline", "spl", "wait", "load"};
    private static final String[] ORIENTATIONS = {"variable", "constant", "ori_joint", "ignore"};
    /** A day: longer waits are refused as mistakes. */
    private static final double MAX_WAIT_S = 86400;
    private static final int MAX_SEGMENTS = 20;

    private final Workcell workcell;

    private MotionReader(Workcell workcell) {
        this.workcell = workcell;
    }

    /** Reads the motions of an instruction with the keys {@code keys}. */
    static MotionList read(Keys keys, JsonValue source) throws Refusal {
        Workcell workcell = new Workcell(keys);
        MotionReader reader = new MotionReader(workcell);
        List<JsonValue> values = keys.list("motions");
        if (values.isEmpty()) {
            throw keys.wrong("`motions` is empty; there has to be at least one");
        }
        List<Motion> motions = new ArrayList<Motion>(values.size());
        for (int i = 0; i < values.size(); i++) {
            motions.add(reader.motion(new Keys(values.get(i), "motion " + (i + 1)), i + 1));
        }
        for (int i = 0; i + 1 < motions.size(); i++) {
            Blend blend = motions.get(i).blend;
            Motion.Type next = motions.get(i + 1).type;
            if (blend != null && blend.hasEffect()
                && (next == Motion.Type.WAIT || next == Motion.Type.LOAD)) {
                throw Refusal.bad("motion " + (i + 1) + " is followed by a "
                    + (next == Motion.Type.WAIT ? "wait" : "change of the load")
                    + " and has nothing to blend into; remove its `blend`");
            }
        }
        return new MotionList(motions, workcell.isT1(), source.asObject());
    }

    private Motion motion(Keys keys, int number) throws Refusal {
        String name = keys.text("type");
        if (!Arrays.asList(TYPES).contains(name)) {
            throw keys.wrong(
                "unknown type `" + Messages.excerpt(name) + "`; known are " + Keys.join(TYPES));
        }
        Motion motion = new Motion(number, Motion.Type.valueOf(name.toUpperCase(Locale.ROOT)));
        switch (motion.type) {
            case WAIT:
                if (keys.isGiven("overlap_motions") || keys.isGiven("overlap")
                    && keys.value("overlap").isTrue()) {
                    throw keys.wrong(
                        "`overlap`: this robot program runs no waits during which the arm moves; "
                        + "plan the motions and run their trajectory");
                }
                if (keys.isGiven("overlap") && !keys.value("overlap").isFalse()) {
                    throw keys.wrong("`overlap` has to be true or false");
                }
                motion.seconds = keys.number("seconds");
                if (!(motion.seconds >= 0 && motion.seconds <= MAX_WAIT_S)) {
                    throw keys.wrong("`seconds` is " + motion.seconds + "; it has to be from 0 to "
                        + MAX_WAIT_S);
                }
                break;
            case LOAD:
                if (!keys.value("load").isNull()) {
                    Workcell.readLoad(keys.object("load"), true);
                }
                break;
            case PTP:
                readPtp(motion, keys);
                break;
            default:
                readPath(motion, keys);
        }
        if (motion.type != Motion.Type.WAIT && motion.type != Motion.Type.LOAD) {
            readBlocking(motion, keys);
        }
        keys.refuseOthers();
        return motion;
    }

    private static void readBlocking(Motion motion, Keys keys) throws Refusal {
        if (keys.isGiven("blocking")) {
            if (!keys.value("blocking").isBoolean()) {
                throw keys.wrong("`blocking` has to be true or false");
            }
            motion.blocking = keys.value("blocking").isTrue();
        }
        if (motion.blocking && motion.blend != null && motion.blend.hasEffect()) {
            throw keys.wrong(
                "it is blocking and cannot be blended: remove its `blend`, or `blocking`");
        }
    }

    private void readPtp(Motion motion, Keys keys) throws Refusal {
        boolean isFrame = keys.isGiven("frame");
        boolean isRad = keys.has("joints_rad");
        boolean isDeg = keys.has("joints_deg");
        if ((isFrame ? 1 : 0) + (isRad ? 1 : 0) + (isDeg ? 1 : 0) != 1) {
            throw keys.wrong("give exactly one of `joints_deg`, `joints_rad` and `frame`");
        }
        String base = readPlace(motion, keys);
        if (isFrame) {
            motion.frame = workcell.target(keys, "frame", base);
        } else {
            motion.jointsRad = keys.numbers(isRad ? "joints_rad" : "joints_deg", 7);
            for (int j = 0; isDeg && j < 7; j++) {
                motion.jointsRad[j] = Math.toRadians(motion.jointsRad[j]);
            }
        }
        motion.limits = Limits.ofJoints(keys);
        motion.blend = keys.isGiven("blend") ? Blend.ofPtp(keys.object("blend")) : null;
    }

    private void readPath(Motion motion, Keys keys) throws Refusal {
        String base = readPlace(motion, keys);
        motion.limits = Limits.ofPath(keys);
        motion.blend = keys.isGiven("blend") ? Blend.ofPath(keys.object("blend")) : null;
        motion.orientation = orientation(keys);
        boolean isSpline = motion.type == Motion.Type.SPLINE || motion.type == Motion.Type.SPL;
        if (isSpline && motion.orientation == Motion.Orientation.ORI_JOINT) {
            throw keys.wrong(
                "`orientation` `ori_joint` is for lin, lin_rel and circ, not for splines");
        }
        if (!isSpline && motion.orientation == Motion.Orientation.IGNORE) {
            throw keys.wrong("`orientation` `ignore` is for the segments of a spline");
        }
        switch (motion.type) {
            case LIN_REL:
                Keys offset = keys.object("offset");
                motion.offset = Workcell.pose(offset, false);
                offset.refuseOthers();
                boolean isTcp = !keys.isGiven("in") || keys.value("in").isString()
                    && keys.text("in").equals("tcp");
                motion.in = isTcp ? null : workcell.target(keys, "in", base);
                Double e1Deg = keys.numberIfGiven("e1_deg");
                motion.e1Rad = e1Deg == null ? null : Double.valueOf(Math.toRadians(e1Deg));
                break;
            case CIRC:
                readCircle(motion, keys, base);
                break;
            case SPLINE:
                motion.segments = segments(motion, keys, base);
                break;
            default:
                motion.frame = workcell.target(keys, "frame", base);
        }
    }

    /** Reads the TCP of a motion, and returns the base of its frames. */
    private String readPlace(Motion motion, Keys keys) throws Refusal {
        String tool = keys.textIfGiven("tool");
        try {
            motion.tcp = workcell.tcp(tool);
        } catch (Refusal refusal) {
            throw keys.wrong(refusal.getMessage());
        }
        String base = keys.textIfGiven("base");
        workcell.checkBase(keys, base);
        return base;
    }

    private static Motion.Orientation orientation(Keys keys) throws Refusal {
        return Motion.Orientation.valueOf(
            keys.word("orientation", ORIENTATIONS).toUpperCase(Locale.ROOT));
    }

    private void readCircle(Motion motion, Keys keys, String base) throws Refusal {
        motion.aux = workcell.target(keys, "aux", base);
        motion.frame = workcell.target(keys, "frame", base);
        Double angle = keys.numberIfGiven("circ_angle_deg");
        if (angle != null && (angle == 0 || Math.abs(angle) > 360)) {
            throw keys.wrong(
                "`circ_angle_deg` is " + angle + "; it has to be from -360 to 360, and not 0");
        }
        motion.circAngleRad = angle == null ? null : Double.valueOf(Math.toRadians(angle));
        motion.turnsWithPath = keys.word("orientation_reference", "base", "path").equals("path");
        motion.auxOrientation = keys.word("aux_orientation", "consider", "interpolate", "ignore");
        motion.endOrientation = keys.word("end_orientation", "interpolate", "extrapolate");
        if (angle != null && motion.auxOrientation.equals("interpolate")) {
            throw keys.wrong(
                "`aux_orientation` cannot be `interpolate` on a circle with `circ_angle_deg`");
        }
    }

    private List<Motion> segments(Motion spline, Keys keys, String base) throws Refusal {
        List<JsonValue> values = keys.list("segments");
        if (values.isEmpty() || values.size() > MAX_SEGMENTS) {
            throw keys.wrong("`segments` has " + values.size()
                + " values; it has to have from 1 to " + MAX_SEGMENTS);
        }
        List<Motion> segments = new ArrayList<Motion>(values.size());
        for (int i = 0; i < values.size(); i++) {
            String where = "motion " + spline.number + ": `segments`, segment " + (i + 1);
            segments.add(segment(spline, new Keys(values.get(i), where), base));
        }
        return segments;
    }

    private Motion segment(Motion spline, Keys keys, String base) throws Refusal {
        keys.value("type");
        String type = keys.word("type", "spl", "lin", "circ");
        Motion segment =
            new Motion(spline.number, Motion.Type.valueOf(type.toUpperCase(Locale.ROOT)));
        if (keys.isGiven("blend")) {
            throw keys.wrong("a segment cannot have a `blend`: blend the whole spline");
        }
        segment.tcp = spline.tcp;
        segment.limits = Limits.ofPath(keys);
        segment.orientation = keys.isGiven("orientation") ? orientation(keys) : null;
        if (segment.orientation == Motion.Orientation.ORI_JOINT) {
            throw keys.wrong(
                "`orientation` `ori_joint` is for lin, lin_rel and circ, not for splines");
        }
        if (segment.type == Motion.Type.CIRC) {
            readCircle(segment, keys, base);
        } else {
            segment.frame = workcell.target(keys, "frame", base);
            // Keys of circular motions are allowed with their default values.
            boolean isPlain = !keys.isGiven("aux") && !keys.isGiven("circ_angle_deg")
                && keys.word("orientation_reference", "base", "path").equals("base")
                && keys.word("aux_orientation", "consider", "interpolate", "ignore")
                .equals("consider")
                && keys.word("end_orientation", "interpolate", "extrapolate").equals("interpolate");
            if (!isPlain) {
                throw keys.wrong(
                    "`aux`, `circ_angle_deg`, `orientation_reference`, `aux_orientation` and"
                    + " `end_orientation` are for segments of `type` `circ`");
            }
        }
        keys.refuseOthers();
        return segment;
    }
}

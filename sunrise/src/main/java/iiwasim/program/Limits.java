package iiwasim.program;

import java.util.Arrays;

/** Limits of a motion: shares of the joint limits, and TCP limits. */
public final class Limits {
    /** Minimum share; smaller shares are refused as mistakes. */
    private static final double MIN_SHARE = 1e-6;

    private static final String[] SHARES = {"velocity_rel", "acceleration_rel", "jerk_rel"};
    private static final String[] TOOL =
        {"cart_velocity_mm_s", "cart_acceleration_mm_s2", "cart_jerk_mm_s3",
        "orientation_velocity_deg_s", "orientation_acceleration_deg_s2", "orientation_jerk_deg_s3"};
    private static final double[] MIN_TOOL = {1e-3, 1, 1e-3, 1e-3, 0.1, 1e-3};

    private final double[][] shares = new double[3][];
    private final Double[] tool = new Double[6];

    private Limits() {
    }

    /** Reads shares of the joint limits. */
    static Limits ofJoints(Keys keys) throws Refusal {
        Limits limits = new Limits();
        for (int kind = 0; kind < 3; kind++) {
            if (keys.has(SHARES[kind])) {
                limits.shares[kind] = shares(keys, SHARES[kind]);
            }
        }
        return limits;
    }

    /** Reads shares of the joint limits and TCP limits, any of which may be null. */
    static Limits ofPath(Keys keys) throws Refusal {
        Limits limits = new Limits();
        for (int kind = 0; kind < 3; kind++) {
            if (keys.isGiven(SHARES[kind])) {
                limits.shares[kind] = shares(keys, SHARES[kind]);
            }
        }
        for (int i = 0; i < TOOL.length; i++) {
            Double limit = keys.numberIfGiven(TOOL[i]);
            if (limit != null && limit < MIN_TOOL[i]) {
                throw keys.wrong(
                    "`" + TOOL[i] + "` is " + limit + "; it has to be at least " + MIN_TOOL[i]);
            }
            limits.tool[i] = limit == null || i < 3 ? limit : Double.valueOf(Math.toRadians(limit));
        }
        return limits;
    }

    private static double[] shares(Keys keys, String name) throws Refusal {
        double[] shares = new double[7];
        if (keys.value(name).isArray()) {
            shares = keys.numbers(name, 7);
        } else {
            Arrays.fill(shares, keys.number(name));
        }
        for (double share : shares) {
            if (!(share >= MIN_SHARE && share <= 1)) {
                throw keys.wrong(
                    "`" + name + "` is " + share + "; it has to be above 0 and at most 1");
            }
        }
        return shares;
    }

    /** Shares of the joint velocity limits, A1 to A7; null for the full limits. */
    public double[] velocityRel() {
        return shares[0];
    }

    /** Shares of the joint acceleration limits, A1 to A7; null for the full limits. */
    public double[] accelerationRel() {
        return shares[1];
    }

    /** Shares of the joint jerk limits, A1 to A7; null for the full limits. */
    public double[] jerkRel() {
        return shares[2];
    }

    /** TCP speed limit, in mm/s; null without a limit. */
    public Double cartVelocity() {
        return tool[0];
    }

    /** TCP acceleration limit, in mm/s^2; null without a limit. */
    public Double cartAcceleration() {
        return tool[1];
    }

    /** TCP jerk limit, in mm/s^3; null without a limit. */
    public Double cartJerk() {
        return tool[2];
    }

    /** Angular TCP speed limit, in rad/s; null without a limit. */
    public Double orientationVelocity() {
        return tool[3];
    }

    /** Angular TCP acceleration limit, in rad/s^2; null without a limit. */
    public Double orientationAcceleration() {
        return tool[4];
    }

    /** Angular TCP jerk limit, in rad/s^3; null without a limit. */
    public Double orientationJerk() {
        return tool[5];
    }
}

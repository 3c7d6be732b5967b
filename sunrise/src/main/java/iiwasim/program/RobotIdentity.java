package iiwasim.program;

import com.eclipsesource.json.JsonObject;

/**
 * Identity of the robot at the cabinet: model and flange. The drive refuses runs if it differs from
 * the robot of the drive.
 */
public final class RobotIdentity {
    /** Model names for {@code robot} in the settings. */
    public static final String MODELS = "lbr_iiwa_7_r800 or lbr_iiwa_14_r820";

    private final String model;
    /** Lengths d1, d3, d5 and d7 of the Denavit-Hartenberg parameters, in mm. */
    private final double baseMm;
    private final double upperArmMm;
    private final double forearmMm;
    private final double flangeMm;

    private RobotIdentity(
        String model, double baseMm, double upperArmMm, double forearmMm, double flangeMm) {
        this.model = model;
        this.baseMm = baseMm;
        this.upperArmMm = upperArmMm;
        this.forearmMm = forearmMm;
        this.flangeMm = flangeMm;
    }

    /** The robot of this model; null for an unknown model. */
    public static RobotIdentity of(String model, double flangeMm) {
        if (model.equals("lbr_iiwa_7_r800")) {
            return new RobotIdentity(model, 340, 400, 400, flangeMm);
        }
        if (model.equals("lbr_iiwa_14_r820")) {
            return new RobotIdentity(model, 360, 420, 400, flangeMm);
        }
        return null;
    }

    /** The identity in JSON, as in the state. */
    public JsonObject json() {
        JsonObject lengths = new JsonObject().add("base", baseMm).add("upper_arm", upperArmMm)
            .add("forearm", forearmMm)
            .add("flange", flangeMm);
        return new JsonObject().add("model", model).add("lengths_mm", lengths);
    }

    @Override
    public String toString() {
        return model + " with a flange of " + flangeMm + " mm";
    }
}

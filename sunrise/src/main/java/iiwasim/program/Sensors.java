package iiwasim.program;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonArray;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;

/** Readings of the robot's sensors. */
public final class Sensors {
    private final double[] temperaturesC;
    private final double[] externalTorquesNm;

    /**
     * Readings of joints A1 to A7.
     *
     * @param temperaturesC in degrees Celsius; null if not measured
     * @param externalTorquesNm in Nm
     */
    public Sensors(double[] temperaturesC, double[] externalTorquesNm) {
        this.temperaturesC = temperaturesC;
        this.externalTorquesNm = externalTorquesNm;
    }

    JsonObject json() {
        return new JsonObject().add("joint_temperature_c", list(temperaturesC))
            .add("external_torque_nm", list(externalTorquesNm));
    }

    private static JsonValue list(double[] values) {
        if (values == null) {
            return Json.NULL;
        }
        JsonArray list = new JsonArray();
        for (double value : values) {
            list.add(value);
        }
        return list;
    }
}

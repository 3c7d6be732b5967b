package iiwasim.program;

import com.eclipsesource.json.JsonObject;

/** Conditions of robot motion. Unknown values are null. */
public final class Conditions {
    private final String operationMode;
    private final Double override;
    private final Boolean safetyStop;
    private final String tool;

    /**
     * Creates current conditions.
     *
     * @param operationMode {@code t1}, {@code t2} or {@code aut}
     * @param override the share of the programmed speed, 0 to 1
     * @param safetyStop true if a safety stop is active
     * @param tool the tool at the flange
     */
    public Conditions(String operationMode, Double override, Boolean safetyStop, String tool) {
        this.operationMode = operationMode;
        this.override = override;
        this.safetyStop = safetyStop;
        this.tool = tool;
    }

    public String operationMode() {
        return operationMode;
    }

    public boolean isSafetyStop() {
        return Boolean.TRUE.equals(safetyStop);
    }

    JsonObject json() {
        JsonObject json = new JsonObject();
        if (operationMode != null) {
            json.add("operation_mode", operationMode);
        }
        if (override != null) {
            json.add("override", override.doubleValue());
        }
        if (safetyStop != null) {
            json.add("safety_stop", safetyStop.booleanValue());
        }
        if (tool != null) {
            json.add("tool", tool);
        }
        return json;
    }
}

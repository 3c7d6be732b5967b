package com.kuka.roboticsAPI.ioModel;

import com.kuka.roboticsAPI.controllerModel.Controller;
import java.util.HashMap;
import java.util.Map;

/** Stub of the KUKA type: see src/stubs/README.md. */
public abstract class AbstractIOGroup {
    /** Calls of the group, for tests. */
    public final StringBuilder calls = new StringBuilder();
    private final Map<String, Object> values = new HashMap<String, Object>();

    public AbstractIOGroup(Controller controller, String name) {
        calls.append(name);
    }

    protected void addInput(String name, IOTypes type, int bits) {
        values.put(name, type == IOTypes.BOOLEAN ? (Object) false : (Object) 0L);
    }

    protected void addDigitalOutput(String name, IOTypes type, int bits) {
        addInput(name, type, bits);
    }

    protected void addAnalogOutput(String name, IOTypes type, int bits, double min, double max) {
        values.put(name, 0.0);
    }

    protected boolean getBooleanIOValue(String name, boolean isOutput) {
        return (Boolean) values.get(name);
    }

    protected Number getNumberIOValue(String name, boolean isOutput) {
        return (Number) values.get(name);
    }

    protected double getAnalogIOValue(String name, boolean isOutput) {
        return ((Number) values.get(name)).doubleValue();
    }

    protected void setDigitalOutput(String name, Boolean value) {
        values.put(name, value);
    }

    protected void setDigitalOutput(String name, Long value) {
        values.put(name, value);
    }

    protected void setAnalogOutput(String name, double value) {
        values.put(name, value);
    }
}

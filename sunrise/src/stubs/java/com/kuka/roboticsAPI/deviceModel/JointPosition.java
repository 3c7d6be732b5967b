package com.kuka.roboticsAPI.deviceModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class JointPosition {
    private final double[] values;

    public JointPosition(double... values) {
        this.values = values.clone();
    }

    public double get(int joint) {
        return values[joint];
    }
}

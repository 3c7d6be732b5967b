package com.kuka.roboticsAPI.deviceModel;

/** A stub of ours: see src/stubs/README.md. */
public class JointPosition {
    private final double[] values;

    public JointPosition(double... values) {
        this.values = values.clone();
    }

    public double get(int joint) {
        return values[joint];
    }
}

package com.kuka.roboticsAPI.sensorModel;

/** A stub of ours: see src/stubs/README.md. */
public interface TorqueSensorData {
    double[] getTorqueValues();
}

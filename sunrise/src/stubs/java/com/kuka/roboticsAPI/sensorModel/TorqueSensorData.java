package com.kuka.roboticsAPI.sensorModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface TorqueSensorData {
    double[] getTorqueValues();
}

package com.kuka.roboticsAPI.applicationModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface RoboticsContext {
    <T> T getDeviceFromType(Class<T> type);
}

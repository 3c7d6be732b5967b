package com.kuka.roboticsAPI.applicationModel;

/** A stub of ours: see src/stubs/README.md. */
public interface RoboticsContext {
    <T> T getDeviceFromType(Class<T> type);
}

package com.kuka.roboticsAPI.applicationModel;

import com.kuka.task.ITaskLogger;

/** Stub of the KUKA type: see src/stubs/README.md. */
public abstract class RoboticsAPIApplication {
    public static RoboticsContext context;
    public static ITaskLogger logger;
    public static IApplicationControl control;
    public static IApplicationData data;

    public void initialize() throws Exception {
    }

    public abstract void run() throws Exception;

    public void dispose() throws Exception {
    }

    public RoboticsContext getContext() {
        return context;
    }

    public ITaskLogger getLogger() {
        return logger;
    }

    public IApplicationControl getApplicationControl() {
        return control;
    }

    public IApplicationData getApplicationData() {
        return data;
    }

    public void onApplicationStateChanged(RoboticsAPIApplicationState state) {
    }
}

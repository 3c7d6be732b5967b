package com.kuka.roboticsAPI.controllerModel.sunrise;

import com.kuka.roboticsAPI.executionModel.IExecutionService;

/** A stub of ours: see src/stubs/README.md. */
public interface SunriseExecutionService extends IExecutionService {
    boolean isPaused();
}

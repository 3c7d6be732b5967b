package com.kuka.roboticsAPI.controllerModel.sunrise;

import com.kuka.roboticsAPI.executionModel.IExecutionService;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface SunriseExecutionService extends IExecutionService {
    boolean isPaused();
}

package com.kuka.roboticsAPI.controllerModel;

import com.kuka.roboticsAPI.executionModel.IExecutionService;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface Controller {
    String getName();

    IExecutionService getExecutionService();
}

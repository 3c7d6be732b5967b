package com.kuka.roboticsAPI.controllerModel;

import com.kuka.roboticsAPI.executionModel.IExecutionService;

/** A stub of ours: see src/stubs/README.md. */
public interface Controller {
    String getName();

    IExecutionService getExecutionService();
}

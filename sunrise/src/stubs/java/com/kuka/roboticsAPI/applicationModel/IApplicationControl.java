package com.kuka.roboticsAPI.applicationModel;

import com.kuka.roboticsAPI.motionModel.IErrorHandler;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IApplicationControl {
    double getApplicationOverride();

    void registerMoveAsyncErrorHandler(IErrorHandler handler);
}

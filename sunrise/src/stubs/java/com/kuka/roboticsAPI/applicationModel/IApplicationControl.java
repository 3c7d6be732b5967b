package com.kuka.roboticsAPI.applicationModel;

import com.kuka.roboticsAPI.motionModel.IErrorHandler;

/** A stub of ours: see src/stubs/README.md. */
public interface IApplicationControl {
    double getApplicationOverride();

    void registerMoveAsyncErrorHandler(IErrorHandler handler);
}

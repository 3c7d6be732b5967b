package com.kuka.roboticsAPI.deviceModel;

import com.kuka.roboticsAPI.controllerModel.Controller;
import com.kuka.roboticsAPI.controllerModel.sunrise.ISafetyState;
import com.kuka.roboticsAPI.geometricModel.Frame;
import com.kuka.roboticsAPI.geometricModel.ObjectFrame;
import com.kuka.roboticsAPI.motionModel.IMotion;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.IMotionContainerListener;
import com.kuka.roboticsAPI.sensorModel.TorqueSensorData;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface LBR {
    boolean isReadyToMove();

    boolean isMastered();

    OperationMode getOperationMode();

    ISafetyState getSafetyState();

    Controller getController();

    JointLimits getJointLimits();

    JointPosition getCurrentJointPosition();

    TorqueSensorData getExternalTorque();

    ObjectFrame getFlange();

    ObjectFrame getRootFrame();

    Frame getCurrentCartesianPosition(ObjectFrame frame);

    IMotionContainer moveAsync(IMotion motion, IMotionContainerListener listener);
}

package com.kuka.roboticsAPI.motionModel;

import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.geometricModel.AbstractFrame;
import com.kuka.roboticsAPI.geometricModel.math.Transformation;

/** Stub of the KUKA type: see src/stubs/README.md. */
public final class BasicMotions {
    private BasicMotions() {
    }

    public static PTP ptp(JointPosition joints) {
        return new PTP(joints.get(0) + ".." + joints.get(6));
    }

    public static CartesianPTP ptp(AbstractFrame frame) {
        return new CartesianPTP(frame);
    }

    public static LIN lin(AbstractFrame frame) {
        return new LIN(frame);
    }

    public static RelativeLIN linRel(Transformation offset) {
        return new RelativeLIN(offset);
    }

    public static RelativeLIN linRel(Transformation offset, AbstractFrame reference) {
        return new RelativeLIN(offset + " in " + reference);
    }

    public static CIRC circ(AbstractFrame aux, AbstractFrame end) {
        return new CIRC(aux + " and " + end);
    }

    public static SPL spl(AbstractFrame frame) {
        return new SPL(frame);
    }
}

package iiwasim.program;

import java.util.List;

/** A motion with all names resolved. Fields that the type of the motion does not use are null. */
public final class Motion {
    /** Types of motions, and of spline segments. */
    public enum Type { PTP, LIN, LIN_REL, CIRC, SPL, SPLINE, WAIT, LOAD }

    /** Orientation control along a path. */
    public enum Orientation { VARIABLE, CONSTANT, ORI_JOINT, IGNORE }

    /** Number of the motion in the program, from 1. */
    public final int number;
    public final Type type;

    /** Target joints A1 to A7 of a point-to-point motion, in rad; null for a target frame. */
    public double[] jointsRad;
    /** Target frame. */
    public Target frame;
    /** Auxiliary frame of a circular motion. */
    public Target aux;
    /** TCP of the motion. */
    public Tcp tcp;
    /** Offset of a relative motion. */
    public Pose offset;
    /** Reference frame for the direction of the offset; null for the TCP. */
    public Target in;
    /** Position of A3 at the end of a relative motion, in rad; null to keep it. */
    public Double e1Rad;
    /** Angle of a circular motion, in rad; null for the angle to the frame. */
    public Double circAngleRad;
    /** Orientation control; null on segments for the orientation control of the spline. */
    public Orientation orientation;
    /** True if the orientation on a circle rotates with the path. */
    public boolean turnsWithPath;
    /**
     * Use of the auxiliary frame's orientation: {@code consider}, {@code interpolate} or {@code
     * ignore}.
     */
    public String auxOrientation;
    /** End orientation of a circle with an angle: {@code interpolate} or {@code extrapolate}. */
    public String endOrientation;
    /** Segments of a spline. */
    public List<Motion> segments;
    public Limits limits;
    /** Blend into the next motion; null for a stop. */
    public Blend blend;

    /** True if the program waits for the end of the motion before it sends the next one. */
    public boolean blocking;
    /** Waiting time, in s. */
    public double seconds;

    Motion(int number, Type type) {
        this.number = number;
        this.type = type;
    }

    /** True if the TCP follows a path. */
    public boolean isPath() {
        return type != Type.PTP && type != Type.WAIT && type != Type.LOAD;
    }
}

package iiwasim.program;

import java.util.List;

/** A motion, with all names resolved. Fields that its type does not have are null. */
public final class Motion {
    /** The types of motions, and of segments of splines. */
    public enum Type { PTP, LIN, LIN_REL, CIRC, SPL, SPLINE, WAIT, LOAD }

    /** How the orientation goes along a path. */
    public enum Orientation { VARIABLE, CONSTANT, ORI_JOINT, IGNORE }

    /** Its place in the program, from 1. */
    public final int number;
    public final Type type;

    /** Joints A1 to A7 of a point-to-point motion, in rad; null if it goes to a frame. */
    public double[] jointsRad;
    /** The frame that it goes to. */
    public Target frame;
    /** The frame on the way of a circle. */
    public Target aux;
    /** The point that it moves. */
    public Tcp tcp;
    /** By how much a relative motion goes. */
    public Pose offset;
    /** In whose orientation the offset is given; null for the TCP. */
    public Target in;
    /** Position of A3 at the end of a relative motion, in rad; null to keep it. */
    public Double e1Rad;
    /** The angle by which a circle goes, in rad; null to the frame. */
    public Double circAngleRad;
    /** How the orientation goes along; null on segments: as the spline says. */
    public Orientation orientation;
    /** Whether the orientation on a circle turns with the path. */
    public boolean turnsWithPath;
    /** What the orientation of the auxiliary frame is for: {@code consider}, {@code interpolate} or {@code ignore}. */
    public String auxOrientation;
    /** Where a circle with an angle reaches the end's orientation: {@code interpolate} or {@code extrapolate}. */
    public String endOrientation;
    /** The segments of a spline. */
    public List<Motion> segments;
    public Limits limits;
    /** How its end is blended into the next motion; null for a stop. */
    public Blend blend;

    /** Whether the program waits for its end before it sends the next motion. */
    public boolean blocking;
    /** How long the arm waits, in s. */
    public double seconds;

    Motion(int number, Type type) {
        this.number = number;
        this.type = type;
    }

    /** Whether the TCP follows a path. */
    public boolean isPath() {
        return type != Type.PTP && type != Type.WAIT && type != Type.LOAD;
    }
}

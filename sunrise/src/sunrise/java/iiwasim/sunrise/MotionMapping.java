package iiwasim.sunrise;

import static com.kuka.roboticsAPI.motionModel.BasicMotions.circ;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.lin;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.linRel;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.ptp;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.spl;

import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.deviceModel.LBRE1Redundancy;
import com.kuka.roboticsAPI.deviceModel.OperationMode;
import com.kuka.roboticsAPI.geometricModel.Frame;
import com.kuka.roboticsAPI.geometricModel.ObjectFrame;
import com.kuka.roboticsAPI.geometricModel.Tool;
import com.kuka.roboticsAPI.geometricModel.math.Transformation;
import com.kuka.roboticsAPI.motionModel.OrientationReferenceSystem;
import com.kuka.roboticsAPI.motionModel.RobotMotion;
import com.kuka.roboticsAPI.motionModel.Spline;
import com.kuka.roboticsAPI.motionModel.SplineMotionCP;
import com.kuka.roboticsAPI.motionModel.SplineOrientationType;

import iiwasim.program.Limits;
import iiwasim.program.Messages;
import iiwasim.program.Motion;
import iiwasim.program.MotionList;
import iiwasim.program.Pose;
import iiwasim.program.Refusal;
import iiwasim.program.Target;
import iiwasim.program.Tcp;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.Locale;

/**
 * Conversion of motions to the RoboticsAPI of KUKA. An option without a counterpart is refused, as
 * ignoring it would change the planned motion.
 */
final class MotionMapping {
    /** Tolerance between a TCP of the program and the TCP of the tool in Sunrise. */
    private static final double TCP_MM = 0.1;
    private static final double TCP_RAD = Math.toRadians(0.1);

    /** Limits are compared with this tolerance, in rad. */
    private static final double ROUNDING = 1e-9;

    private final LBR robot;
    private final Tool tool;
    private final String toolName;

    MotionMapping(LBR robot, Tool tool, String toolName) {
        this.robot = robot;
        this.tool = tool;
        this.toolName = toolName;
    }

    /** The motions, divided at waits and at changes of the TCP. */
    List<Leg> legs(MotionList list, int batch) throws Refusal {
        if (list.isT1() && robot.getOperationMode() != OperationMode.T1) {
            throw Refusal.robot(
                "the program is for T1, and the robot is in " + robot.getOperationMode()
                + ": leave out `mode`, or switch to T1");
        }
        List<Leg> legs = new ArrayList<Leg>();
        Tcp before = null;
        Leg leg = null;
        Motion blended = null;
        RobotMotion<?> last = null;
        for (Motion motion : list.motions()) {
            if (motion.type == Motion.Type.LOAD) {
                throw wrong(motion, "a change of the load is not mapped to Sunrise yet, and the "
                    + "controller has to know what hangs"
                    + " on the flange; leave it out, and give the tool in Sunrise the load");
            }
            if (motion.type == Motion.Type.WAIT) {
                if (leg == null) {
                    leg = new Leg(robot.getFlange());
                    legs.add(leg);
                }
                leg.waitS += motion.seconds;
                blended = null;
                before = null;
                continue;
            }
            boolean isSamePoint = before != null
                && (motion.jointsRad != null || isSame(before, motion.tcp));
            if (!isSamePoint) {
                if (blended != null) {
                    throw wrong(motion, "the motion before has a blend, and another point moves "
                        + "here; Sunrise stops there:"
                        + " remove that blend");
                }
                before = motion.tcp;
                leg = new Leg(frame(motion));
                legs.add(leg);
            }
            if (blended != null) {
                // Not for a last motion, which Sunrise would stop at the blend start instead of the
                // target.
                blend(last, blended);
            }
            last = motion(motion);
            leg.add(last, batch);
            blended = motion.blend == null ? null : motion;
            if (motion.blocking) {
                before = null;
            }
        }
        return legs;
    }

    private static boolean isSame(Tcp a, Tcp b) {
        return a.toString().equals(b.toString());
    }

    private static Refusal wrong(Motion motion, String what) {
        return Refusal.bad("motion " + motion.number + ": " + what);
    }

    /**
     * The TCP of a motion. Its pose is taken from the Sunrise tool, whose load the controller
     * knows.
     */
    private ObjectFrame frame(Motion motion) throws Refusal {
        if (motion.tcp.isFlange()) {
            return robot.getFlange();
        }
        if (tool == null || !motion.tcp.tool().equals(toolName)) {
            throw wrong(motion, "it moves the tool `" + Messages.excerpt(motion.tcp.tool())
                + "`, and "
                + (tool == null ? "no tool is attached" : "`" + toolName + "` is attached")
                + ": the setting `tool` has to name it, and the Sunrise project has to have a "
                + "template of this name");
        }
        ObjectFrame frame;
        try {
            frame = motion.tcp.tip() == null ? tool.getDefaultMotionFrame()
                : tool.getFrame("/" + motion.tcp.tip());
        } catch (RuntimeException error) {
            throw wrong(motion, "the tool in Sunrise has no frame `/"
                + Messages.excerpt(motion.tcp.tip()) + "`");
        }
        // From two readings at rest: TCP and flange poses in the same frame.
        Pose inSunrise = pose(robot.getCurrentCartesianPosition(robot.getFlange())).inverse()
            .then(pose(robot.getCurrentCartesianPosition(frame)));
        double offMm = inSunrise.distanceMm(motion.tcp.pose());
        double offRad = inSunrise.angleRad(motion.tcp.pose());
        if (offMm > TCP_MM || offRad > TCP_RAD) {
            throw wrong(motion,
                String.format(Locale.ROOT, "the TCP of `%s` is %.1f mm and %.2f deg off that of the"
                + " tool in Sunrise: correct one of them", motion.tcp, offMm,
                Math.toDegrees(offRad)));
        }
        return frame;
    }

    private static Pose pose(Frame frame) {
        return Pose.of(
            frame.getX(), frame.getY(), frame.getZ(), frame.getAlphaRad(), frame.getBetaRad(),
            frame.getGammaRad());
    }

    private RobotMotion<?> motion(Motion motion) throws Refusal {
        RobotMotion<?> mapped;
        switch (motion.type) {
            case PTP:
                mapped = motion.jointsRad == null ? ptp(frame(motion.frame)) : ptp(joints(motion));
                break;
            case SPLINE:
                mapped = spline(motion);
                break;
            default:
                SplineMotionCP<?> path = path(motion);
                apply(path, motion.limits, motion.limits);
                mapped = path;
        }
        if (motion.type != Motion.Type.SPLINE) {
            joints(mapped, motion.limits, motion.limits);
        }
        return mapped;
    }

    private static void blend(RobotMotion<?> mapped, Motion motion) {
        if (motion.blend.sunriseRel() != null) {
            mapped.setBlendingRel(motion.blend.sunriseRel());
        }
        if (motion.blend.cartMm() != null) {
            mapped.setBlendingCart(motion.blend.cartMm());
        }
        if (motion.blend.oriRad() != null) {
            mapped.setBlendingOri(motion.blend.oriRad());
        }
    }

    private JointPosition joints(Motion motion) throws Refusal {
        JointPosition max = robot.getJointLimits().getMaxJointPosition();
        JointPosition min = robot.getJointLimits().getMinJointPosition();
        for (int j = 0; j < 7; j++) {
            double q = motion.jointsRad[j];
            if (q > max.get(j) + ROUNDING || q < min.get(j) - ROUNDING) {
                throw new Refusal(Refusal.Code.LIMIT, "motion " + motion.number + ": joint A"
                    + (j + 1) + " is at "
                    + Messages.degrees(q) + "; its range is " + Messages.degrees(min.get(j))
                    + " to "
                    + Messages.degrees(max.get(j)));
            }
        }
        return new JointPosition(motion.jointsRad);
    }

    /** A frame relative to the robot foot. */
    private Frame frame(Target target) {
        double[] xyz = target.pose().xyzMm();
        double[] abc = target.pose().abcRad();
        Frame frame = new Frame(
            robot.getRootFrame(), xyz[0], xyz[1], xyz[2], abc[0], abc[1], abc[2]);
        if (target.e1Rad() != null || target.status() != null || target.turn() != null) {
            LBRE1Redundancy redundancy = new LBRE1Redundancy();
            if (target.e1Rad() != null) {
                redundancy.setE1(target.e1Rad());
            }
            if (target.status() != null) {
                redundancy.setStatus(target.status());
            }
            if (target.turn() != null) {
                redundancy.setTurn(target.turn());
            }
            frame.setRedundancyInformation(robot, redundancy);
        }
        return frame;
    }

    private SplineMotionCP<?> path(Motion motion) throws Refusal {
        SplineMotionCP<?> path;
        switch (motion.type) {
            case LIN:
                path = lin(frame(motion.frame));
                break;
            case SPL:
                path = spl(frame(motion.frame));
                break;
            case CIRC:
                path = circle(motion);
                break;
            default:
                if (motion.e1Rad != null) {
                    throw wrong(motion, "`e1_deg` of a relative motion has no counterpart in "
                        + "Sunrise; give the frame");
                }
                double[] xyz = motion.offset.xyzMm();
                double[] abc = motion.offset.abcRad();
                Transformation offset =
                    Transformation.ofRad(xyz[0], xyz[1], xyz[2], abc[0], abc[1], abc[2]);
                path = motion.in == null ? linRel(offset) : linRel(offset, frame(motion.in));
        }
        if (motion.orientation != null) {
            path.setOrientationType(orientation(motion.orientation));
        }
        return path;
    }

    private SplineMotionCP<?> circle(Motion motion) throws Refusal {
        if (motion.circAngleRad != null) {
            throw wrong(motion,
                "`circ_angle_deg` is not mapped to Sunrise yet; give the frame at the end");
        }
        if (!motion.auxOrientation.equals("consider")
            || !motion.endOrientation.equals("interpolate")) {
            throw wrong(motion, "`aux_orientation` and `end_orientation` are not mapped to "
                + "Sunrise yet; leave them out");
        }
        SplineMotionCP<?> path = circ(frame(motion.aux), frame(motion.frame));
        path.setOrientationReferenceSystem(
            motion.turnsWithPath ? OrientationReferenceSystem.Path
            : OrientationReferenceSystem.Base);
        return path;
    }

    private static SplineOrientationType orientation(Motion.Orientation orientation) {
        switch (orientation) {
            case CONSTANT:
                return SplineOrientationType.Constant;
            case ORI_JOINT:
                return SplineOrientationType.OriJoint;
            case IGNORE:
                return SplineOrientationType.Ignore;
            default:
                return SplineOrientationType.VariableOrientation;
        }
    }

    /** Converts a spline. Its limits are set on each segment without its own limits. */
    private Spline spline(Motion spline) throws Refusal {
        List<SplineMotionCP<?>> segments = new ArrayList<SplineMotionCP<?>>();
        for (Motion segment : spline.segments) {
            if (segment.orientation == null) {
                segment.orientation = spline.orientation;
            }
            SplineMotionCP<?> path = path(segment);
            apply(path, segment.limits, spline.limits);
            joints(path, segment.limits, spline.limits);
            segments.add(path);
        }
        return new Spline(segments.toArray(new SplineMotionCP<?>[segments.size()]));
    }

    private static void joints(RobotMotion<?> motion, Limits own, Limits otherwise) {
        double[] velocity = either(own.velocityRel(), otherwise.velocityRel());
        double[] acceleration = either(own.accelerationRel(), otherwise.accelerationRel());
        double[] jerk = either(own.jerkRel(), otherwise.jerkRel());
        if (velocity != null && isOne(velocity)) {
            motion.setJointVelocityRel(velocity[0]);
        } else if (velocity != null) {
            motion.setJointVelocityRel(velocity);
        }
        if (acceleration != null && isOne(acceleration)) {
            motion.setJointAccelerationRel(acceleration[0]);
        } else if (acceleration != null) {
            motion.setJointAccelerationRel(acceleration);
        }
        if (jerk != null && isOne(jerk)) {
            motion.setJointJerkRel(jerk[0]);
        } else if (jerk != null) {
            motion.setJointJerkRel(jerk);
        }
    }

    private static boolean isOne(double[] shares) {
        double[] same = new double[shares.length];
        Arrays.fill(same, shares[0]);
        return Arrays.equals(shares, same);
    }

    private static void apply(SplineMotionCP<?> path, Limits own, Limits otherwise) {
        Double velocity = either(own.cartVelocity(), otherwise.cartVelocity());
        Double acceleration = either(own.cartAcceleration(), otherwise.cartAcceleration());
        Double jerk = either(own.cartJerk(), otherwise.cartJerk());
        Double turning = either(own.orientationVelocity(), otherwise.orientationVelocity());
        Double turningAcceleration =
            either(own.orientationAcceleration(), otherwise.orientationAcceleration());
        Double turningJerk = either(own.orientationJerk(), otherwise.orientationJerk());
        if (velocity != null) {
            path.setCartVelocity(velocity);
        }
        if (acceleration != null) {
            path.setCartAcceleration(acceleration);
        }
        if (jerk != null) {
            path.setCartJerk(jerk);
        }
        if (turning != null) {
            path.setOrientationVelocity(turning);
        }
        if (turningAcceleration != null) {
            path.setOrientationAcceleration(turningAcceleration);
        }
        if (turningJerk != null) {
            path.setOrientationJerk(turningJerk);
        }
    }

    private static <T> T either(T own, T otherwise) {
        return own == null ? otherwise : own;
    }
}

// Wrapper of WebGL: programs, meshes, and textures as render targets.

/** The painter of a canvas; null without WebGL 2. */
function makePainter(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: false });
  if (!gl) return null;

  const compiled = (vertex, fragment) => {
    const program = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text.replace("[LINKS]", `[${model.joints.length + 1}]`));
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program));
    program.uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
      const { name } = gl.getActiveUniform(program, i);
      program.uniforms[name] = gl.getUniformLocation(program, name);
    }
    program.places = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); i++) {
      const { name } = gl.getActiveAttrib(program, i);
      program.places[name] = gl.getAttribLocation(program, name);
    }
    return program;
  };

  /** Uploads interleaved vertex attributes with their sizes, and triangles of vertex indices, or of
      the vertices in their order. */
  const upload = (layout, floats, triangles) => {
    const stride = layout.reduce((sum, [, size]) => sum + size, 0);
    const mesh = { layout, stride, count: triangles ? triangles.length : floats.length / stride };
    const put = (kind, values) => {
      const made = gl.createBuffer();
      gl.bindBuffer(kind, made);
      gl.bufferData(kind, values, gl.STATIC_DRAW);
      return made;
    };
    mesh.corners = put(gl.ARRAY_BUFFER, new Float32Array(floats));
    if (triangles) mesh.triangles = put(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(triangles));
    return mesh;
  };
  const discard = ({ corners, triangles }) => {
    gl.deleteBuffer(corners);
    if (triangles) gl.deleteBuffer(triangles);
  };

  const painter = { gl, compiled, upload, discard, program: null };
  painter.use = (program) => {
    painter.program = program;
    gl.useProgram(program);
    return program.uniforms;
  };
  /** Draws a mesh, or its first `count` indices, with the program in use and its attributes. */
  painter.draw = (mesh, count = mesh.count) => {
    const { places } = painter.program;
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.corners);
    let offset = 0;
    for (const [name, size] of mesh.layout) {
      const place = places[name];
      if (place !== undefined) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * mesh.stride, 4 * offset);
      }
      offset += size;
    }
    if (mesh.triangles) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    } else {
      gl.drawArrays(gl.TRIANGLES, 0, count);
    }
    // Its buffers may be deleted before the next mesh is drawn.
    for (const place of Object.values(places)) gl.disableVertexAttribArray(place);
  };

  /** A square texture as a render target, of colours, or of depths for comparison. */
  painter.picture = (size, isDepth) => {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    if (isDepth) gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, size, size);
    else gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, size, size);
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
      ...(isDepth ? [[gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE]] : []),
    ]) {
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    const place = isDepth ? gl.DEPTH_ATTACHMENT : gl.COLOR_ATTACHMENT0;
    gl.framebufferTexture2D(gl.FRAMEBUFFER, place, gl.TEXTURE_2D, texture, 0);
    if (isDepth) gl.drawBuffers([gl.NONE]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { texture, frame, size };
  };
  /** Makes a texture the render target. */
  painter.into = ({ frame, size }) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.viewport(0, 0, size, size);
  };
  /** Binds a texture to a sampler of the program in use. */
  painter.take = (name, number, { texture }) => {
    gl.activeTexture(gl.TEXTURE0 + number);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(painter.program.uniforms[name], number);
  };
  return painter;
}

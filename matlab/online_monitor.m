function online_monitor(block)
%ONLINE_MONITOR Level-2 MATLAB S-function: compute robustness online.
%
%   Put 'online_monitor' into a block "Level-2 MATLAB S-Function", with three
%   parameters:
%
%   1. the specification: its text, its file (.stl), or a program written by
%      'rtamt compile' (.rtamt); to set named constants, a cell array with their
%      names and values: {'response.stl', 'limit', 4},
%   2. the names of its variables, in the order of the elements of the input:
%      {'req', 'gnt'} or 'req, gnt',
%   3. the sampling period in seconds, or -1 to inherit that of the input.
%
%   The input is a vector with one element for each variable. The output is the
%   robustness one horizon ago, and NaN until the horizon has passed. It reflects
%   the input of the same step.
%
%   For the error identifiers 'rtamt:...' see docs/how-to/simulink.md.
%
%   See also RTAMT_ROBUSTNESS, INSTALL_RTAMT.

    block.NumDialogPrms = 3;
    block.DialogPrmsTunable = {'Nontunable', 'Nontunable', 'Nontunable'};
    block.NumInputPorts = 1;
    block.NumOutputPorts = 1;
    block.SetPreCompInpPortInfoToDynamic;
    block.SetPreCompOutPortInfoToDynamic;

    block.InputPort(1).DatatypeID = 0; % double
    block.InputPort(1).Complexity = 'Real';
    block.InputPort(1).SamplingMode = 'Sample';
    block.InputPort(1).DirectFeedthrough = true;
    block.OutputPort(1).Dimensions = 1;
    block.OutputPort(1).DatatypeID = 0;
    block.OutputPort(1).Complexity = 'Real';
    block.OutputPort(1).SamplingMode = 'Sample';

    block.SampleTimes = [sample_time(block.DialogPrm(3).Data), 0];
    block.SimStateCompliance = 'DisallowSimState'; % the state is in the monitor

    block.RegBlockMethod('SetInputPortDimensions', @set_input_dimensions);
    block.RegBlockMethod('PostPropagationSetup', @set_up_work);
    block.RegBlockMethod('Start', @start);
    block.RegBlockMethod('InitializeConditions', @initialize);
    block.RegBlockMethod('Outputs', @outputs);
    block.RegBlockMethod('Update', @update);
    block.RegBlockMethod('Terminate', @terminate);
end

function seconds = sample_time(seconds)
% Check and return the third parameter.
    valid = isnumeric(seconds) && isscalar(seconds) && isreal(seconds) && ...
        (seconds == -1 || (seconds > 0 && isfinite(seconds)));
    if ~valid
        error('rtamt:period', '%s', ['The sampling period must be a number of ' ...
              'seconds above 0, or -1 for that of the input.']);
    end
    seconds = double(seconds);
end

function set_input_dimensions(block, port, dimensions)
% Check the width here, so that the message can name the variables.
    names = variable_names(block.DialogPrm(2).Data);
    width = prod(dimensions);
    if width ~= numel(names)
        error('rtamt:width', ['The input has %d elements, but the block has ' ...
              '%d variables (%s): join one signal for each with a Mux, in this order.'], ...
              width, numel(names), strjoin(names, ', '));
    end
    block.InputPort(port).Dimensions = dimensions;
end

function set_up_work(block)
% Work vectors: the monitor (0 for none), the time of the last sample (NaN for
% none), and the element of the input for each variable of the program.
    names = {'monitor', 'last_time', 'order'};
    widths = [1, 1, numel(variable_names(block.DialogPrm(2).Data))];
    block.NumDworks = numel(names);
    for i = 1:numel(names)
        block.Dwork(i).Name = names{i};
        block.Dwork(i).Dimensions = widths(i);
        block.Dwork(i).DatatypeID = 0;
        block.Dwork(i).Complexity = 'Real';
        block.Dwork(i).UsedAsDiscState = false;
    end
end

function start(block)
    block.Dwork(1).Data = 0;
    block.Dwork(2).Data = NaN;
    period = block.SampleTimes(1);
    if ~(period > 0 && isfinite(period))
        error('rtamt:period', '%s', ['The input has no sampling period: give the ' ...
              'block one in seconds as its third parameter, or put a Zero-Order ' ...
              'Hold or a Rate Transition before it.']);
    end
    [monitor, order] = open_monitor(block.DialogPrm(1).Data, block.DialogPrm(2).Data, period);
    block.Dwork(1).Data = monitor;
    block.Dwork(3).Data = order;
end

function initialize(block)
% Start a new trace, also when a subsystem is enabled with its states reset.
    if block.Dwork(1).Data ~= 0
        rtamt_gateway('reset', block.Dwork(1).Data);
    end
    block.Dwork(2).Data = NaN;
end

function outputs(block)
% Can be called repeatedly in a step, with different inputs: takes no sample.
    if block.IsMajorTimeStep
        known = rtamt_gateway('peek', block.Dwork(1).Data, sample(block));
        block.OutputPort(1).Data = known(1);
    end
end

function update(block)
% Called once per step, when its inputs are final: takes the sample.
    if block.IsMajorTimeStep
        rtamt_gateway('step', block.Dwork(1).Data, sample(block));
        block.Dwork(2).Data = block.CurrentTime;
    end
end

function values = sample(block)
% Return the input in program order; it must be one period after the last one.
    last = block.Dwork(2).Data;
    period = block.SampleTimes(1);
    now = block.CurrentTime;
    if abs(now - last - period) > 1e-6 * period + 4 * eps(now)
        error('rtamt:period', ['A sample comes at %.12g s, but the one before came at ' ...
              '%.12g s and the period is %.12g s: a subsystem that is switched on and ' ...
              'off must reset its states when it is enabled.'], now, last, period);
    end
    values = block.InputPort(1).Data(block.Dwork(3).Data);
end

function terminate(block)
% Also called if the start failed.
    if block.NumDworks > 0 && ~isempty(block.Dwork(1).Data) && block.Dwork(1).Data ~= 0
        rtamt_gateway('destroy', block.Dwork(1).Data);
        block.Dwork(1).Data = 0;
    end
end

classdef RuntimeBlock < handle
% What Simulink hands to a Level-2 S-function, as far as a block uses it, without Simulink.
%
% It refuses what Simulink would refuse: callbacks that do not exist, ports or work vectors
% that were never declared, data of another size.

    properties
        NumDialogPrms = 0
        DialogPrmsTunable = {}
        DialogPrm
        NumInputPorts = 0
        NumOutputPorts = 0
        InputPort = struct('DatatypeID', -1, 'Complexity', 'Inherited', ...
                           'SamplingMode', 'Inherited', 'DirectFeedthrough', false, ...
                           'Dimensions', -1, 'Data', [])
        OutputPort = struct('DatatypeID', -1, 'Complexity', 'Inherited', ...
                            'SamplingMode', 'Inherited', 'Dimensions', -1, 'Data', 0)
        SampleTimes = []
        SimStateCompliance = 'UnknownSimState'
        NumDworks = 0
        Dwork = struct('Name', {}, 'Dimensions', {}, 'DatatypeID', {}, 'Complexity', {}, ...
                       'UsedAsDiscState', {}, 'Data', {})
        CurrentTime = 0
        IsMajorTimeStep = true
        Called = {}   % the callbacks, in the order of their calls
    end

    properties (Access = private)
        Methods = struct()
    end

    methods
        function self = RuntimeBlock(parameters)
            self.DialogPrm = struct('Data', parameters);
        end

        function SetPreCompInpPortInfoToDynamic(self)
            self.InputPort(1).Dimensions = -1;
        end

        function SetPreCompOutPortInfoToDynamic(self)
            self.OutputPort(1).Dimensions = -1;
        end

        function RegBlockMethod(self, name, callback)
            known = {'CheckParameters', 'SetInputPortDimensions', 'PostPropagationSetup', ...
                     'Start', 'InitializeConditions', 'Outputs', 'Update', 'Terminate'};
            assert(any(strcmp(name, known)), 'there is no callback %s', name);
            self.Methods.(name) = callback;
        end

        function call(self, name, varargin)
            self.Called{end + 1} = name;
            callback = self.Methods.(name);
            callback(self, varargin{:});
            self.check_ports();
        end

        function prepare(self, width, input_period)
        % Everything before the first step: `input_period` is that of the signal at the input.
            online_monitor(self);
            assert(self.NumDialogPrms == numel(self.DialogPrm));
            assert(numel(self.DialogPrmsTunable) == self.NumDialogPrms);
            assert(self.NumInputPorts == 1 && self.NumOutputPorts == 1);
            if self.SampleTimes(1) == -1
                self.SampleTimes = [input_period, 0];
            end
            self.call('SetInputPortDimensions', 1, width);
            assert(isequal(self.InputPort(1).Dimensions, width));
            self.call('PostPropagationSetup');
            assert(numel(self.Dwork) == self.NumDworks);
            for i = 1:self.NumDworks
                self.Dwork(i).Data = zeros(self.Dwork(i).Dimensions, 1);
            end
            self.call('Start');
            self.call('InitializeConditions');
        end

        function value = output(self, time, values)
        % The output in a major step; more than one call stands for an algebraic loop.
            self.feed(time, values, true);
            self.call('Outputs');
            value = self.OutputPort(1).Data;
        end

        function minor(self, time, values)
        % A minor step of a solver with a variable step: no Update.
            self.feed(time, values, false);
            before = self.OutputPort(1).Data;
            self.call('Outputs');
            assert(isequaln(before, self.OutputPort(1).Data));
        end

        function update(self, time, values)
            self.feed(time, values, true);
            self.call('Update');
        end

        function value = step(self, time, values)
            value = self.output(time, values);
            self.update(time, values);
        end
    end

    methods (Access = private)
        function feed(self, time, values, major)
            assert(numel(values) == prod(self.InputPort(1).Dimensions));
            self.CurrentTime = time;
            self.IsMajorTimeStep = major;
            self.InputPort(1).Data = values(:);
        end

        function check_ports(self)
            assert(numel(self.InputPort) == 1 && numel(fieldnames(self.InputPort)) == 6);
            assert(numel(self.OutputPort) == 1 && numel(fieldnames(self.OutputPort)) == 5);
            assert(numel(fieldnames(self.Dwork)) == 6);
            assert(isscalar(self.OutputPort(1).Data) && isa(self.OutputPort(1).Data, 'double'));
        end
    end
end
